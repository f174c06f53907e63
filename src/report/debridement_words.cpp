// SPDX-License-Identifier: BSD-3-Clause
#include "debridement_words.h"

#include <cmath>

#include "raven_correction/error.h"
#include "report_json.h"

namespace raven_correction {

double firstTryShare(const DebridementSummary& summary) {
  return summary.first_tries > 0 ? static_cast<double>(summary.first_try_held) / summary.first_tries
                                 : 0.0;
}

double percentOf(std::uint64_t part, std::uint64_t all) {
  return all == 0 ? 0.0 : kPercent * static_cast<double>(part) / static_cast<double>(all);
}

double latePercent(const DebridementReport& report) {
  return percentOf(report.late_cycles, report.cycles);
}

const DebridementCondition* conditionOf(const DebridementReport& report, const std::string& name) {
  for (const DebridementCondition& condition : report.conditions)
    if (condition.name == name) return &condition;
  return nullptr;
}

std::optional<PairedComparison> speedUpOf(const DebridementReport& report,
                                          const std::string& fast) {
  const DebridementCondition* const slow = conditionOf(report, kBaseline);
  const DebridementCondition* const other = conditionOf(report, fast);
  if (slow == nullptr || other == nullptr) return std::nullopt;
  return speedUp(slow->fields, other->fields, report.seed);
}

std::optional<PairedComparison> successOf(const DebridementReport& report,
                                          const std::string& name) {
  const DebridementCondition* const reference = conditionOf(report, kBaseline);
  const DebridementCondition* const other = conditionOf(report, name);
  if (reference == nullptr || other == nullptr) return std::nullopt;
  return successDifference(reference->fields, other->fields, report.seed);
}

const char* successWords(const PairedComparison& difference) {
  if (difference.interval.upper < 0.0) return "lower";
  if (difference.interval.lower > 0.0) return "higher";
  return difference.value == 0.0 ? "the same" : "not told apart by these scenes";
}

const std::vector<DebridementRow>& debridementRows() {
  using C = DebridementCondition;
  using S = DebridementSummary;
  static const std::vector<DebridementRow> rows{
      {"peak speed [cm/s]", [](const C& c, const S&) { return format("%.1f", 100.0 * c.speed); }},
      {"replanning",
       [](const C& c, const S&) {
         if (c.replan_interval > 0.0) return format("every %.1f s", c.replan_interval);
         if (c.deviation_limit > 0.0)
           return format("where sd > %.1f mm", kMillimetre * c.deviation_limit);
         if (c.deviation_limit < 0.0) return std::string("where sd is unusual");
         return std::string("none");
       }},
      {"seconds per fragment",
       [](const C&, const S& s) {
         if (!std::isfinite(s.seconds_per_fragment)) return std::string("none delivered");
         if (!std::isfinite(s.seconds_interval.upper))
           return format("%.1f", s.seconds_per_fragment);
         return format("%.1f (%.1f to %.1f)", s.seconds_per_fragment, s.seconds_interval.lower,
                       s.seconds_interval.upper);
       }},
      {"success [%]",
       [](const C&, const S& s) {
         return format("%.1f (%.1f to %.1f)", kPercent * s.success,
                       kPercent * s.success_interval.lower, kPercent * s.success_interval.upper);
       }},
      {"fragments delivered",
       [](const C&, const S& s) {
         return format("%u of %u, %u scenes", s.delivered, s.fragments, s.scenes);
       }},
      {"gone after the first attempt [%]",
       [](const C&, const S& s) { return format("%.1f", kPercent * firstTryShare(s)); }},
      {"retries per fragment", [](const C&, const S& s) { return format("%.2f", s.retries); }},
      {"jaw closed on nothing", [](const C&, const S& s) { return format("%u", s.missed); }},
      {"given up, dropped",
       [](const C&, const S& s) { return format("%u, %u", s.given_up, s.dropped); }},
      {"measured at rest before closing",
       [](const C&, const S& s) { return format("%u", s.replans); }},
      {"arm's time per picked fragment [s]",
       [](const C&, const S& s) { return format("%.1f", s.busy_per_fragment); }},
      {"waited for the other arm [s]",
       [](const C&, const S& s) { return format("%.1f", s.waited); }},
      {"poses corrected; of all, less than in full [%]",
       [](const C& c, const S&) {
         return c.poses.all == 0 ? std::string("none")
                                 : format("%.1f; %.1f", percentOf(c.poses.corrected, c.poses.all),
                                          percentOf(c.poses.reduced, c.poses.all));
       }},
      {"smallest distance of the arms [mm]", [](const C& c, const S&) {
         return std::isfinite(c.clearance) ? format("%.1f", kMillimetre * c.clearance)
                                           : std::string("one arm");
       }}};
  return rows;
}

}  // namespace raven_correction
