// SPDX-License-Identifier: BSD-3-Clause
#include "raven_correction/report/repeatability_report.h"

#include <limits>

#include "paper_table_two.h"
#include "raven_correction/error.h"
#include "report_json.h"

namespace raven_correction {
namespace {

Json listJson(const Eigen::Matrix<double, 6, 1>& values, int first) {
  Json list = Json::array();
  for (int v = first; v < first + 3; ++v) list.push_back(unitOf(v) * values(v));
  return list;
}

Json conditionJson(const RepeatabilityCondition& condition) {
  const RepeatabilityResult& result = condition.result;
  Json json;
  for (int first : {0, 3}) {
    const std::string unit = unitName(first);
    json["mean_abs_" + unit] = listJson(result.errors.mean_abs, first);
    json["std_" + unit] = listJson(result.repeatability, first);
    json["abs_std_" + unit] = listJson(result.errors.std, first);
    json["mean_error_" + unit] = listJson(result.mean_error, first);
  }
  json["position_norm_mm"] = kMillimetre * result.errors.position_norm;
  json["angle_norm_deg"] = kDegree * result.errors.angle_norm;
  json["n"] = result.visits;
  json["unseen"] = result.unseen;
  json["corrector"] = condition.codes;
  return json;
}

const RepeatabilityCondition* find(const RepeatabilityReport& report, const std::string& name) {
  for (const RepeatabilityCondition& condition : report.conditions)
    if (condition.name == name) return &condition;
  return nullptr;
}

double latePercent(const RepeatabilityReport& report) {
  return report.cycles == 0 ? 0.0
                            : kPercent * static_cast<double>(report.late_cycles) /
                                  static_cast<double>(report.cycles);
}

}  // namespace

double correctedShare(const RepeatabilityReport& report) {
  const RepeatabilityCondition* const none = find(report, "none");
  const RepeatabilityCondition* const full = find(report, "full");
  if (none == nullptr || full == nullptr) return std::numeric_limits<double>::quiet_NaN();
  return full->result.errors.position_norm / none->result.errors.position_norm;
}

std::string repeatabilityText(const RepeatabilityReport& report) {
  std::string text = format(
      "Repeatability (Table II): %zu random poses, each visited %zu times open loop, in random "
      "order\nmean absolute error +- repeatability (scatter of the visits of one pose about their "
      "mean)\nmeasured by %s\n\n            ",
      report.poses, report.visits, report.measured_by.c_str());
  for (const RepeatabilityCondition& condition : report.conditions)
    text += format("  %-24s", condition.name.c_str());
  text += "\n            ";
  for (std::size_t i = 0; i < report.conditions.size(); ++i)
    text += format("  %-13s %-10s", "here", "paper");
  text += "\n";
  for (int v = 0; v < 6; ++v) {
    text += format("  %-5s %-4s", kVariables[v], unitName(v));
    for (const RepeatabilityCondition& condition : report.conditions) {
      const RepeatabilityResult& result = condition.result;
      const PaperCondition* const paper = v < 3 ? paperConditionOf(condition.name) : nullptr;
      text += format("  %5.2f +- %-4.2f", unitOf(v) * result.errors.mean_abs(v),
                     unitOf(v) * result.repeatability(v));
      text += paper == nullptr ? format("%11s", "")
                               : format(" %4.1f +- %-3.1f", paper->mean_abs[v], paper->std[v]);
    }
    text += "\n";
  }
  const auto norms = [&](const char* name, bool position) {
    text += format("  %-10s", name);
    for (const RepeatabilityCondition& condition : report.conditions) {
      const ErrorSummary& errors = condition.result.errors;
      text +=
          format("  %5.2f%19s",
                 position ? kMillimetre * errors.position_norm : kDegree * errors.angle_norm, "");
    }
    text += "\n";
  };
  norms("norm mm", true);
  norms("norm deg", false);
  text += "\n";
  for (const RepeatabilityCondition& condition : report.conditions) {
    const RepeatabilityResult& result = condition.result;
    text += format("  %-9s %zu visits; deviation of |error| over all of them %.2f, %.2f, %.2f mm",
                   condition.name.c_str(), result.visits, kMillimetre * result.errors.std(0),
                   kMillimetre * result.errors.std(1), kMillimetre * result.errors.std(2));
    for (const auto& [code, count] : condition.codes)
      text += format(", %s %llu", code.c_str(), static_cast<unsigned long long>(count));
    text += result.unseen.empty() ? "\n" : format("; %zu not seen\n", result.unseen.size());
  }
  text += format(
      "  full over none: %.3f (norm of the three mean absolute position errors)\n"
      "  learnt from %zu pairs of %zu trajectories\n"
      "  simulator: %llu cycles, %.1f %% of them late, %.2f simulated seconds per second\n",
      correctedShare(report), report.training_pairs, report.training_trajectories,
      static_cast<unsigned long long>(report.cycles), latePercent(report), report.clock_rate);
  if (!report.folder.empty()) text += "  bags, model and log: " + report.folder + "\n";
  return text;
}

std::string repeatabilityJson(const RepeatabilityReport& report) {
  Json json;
  json["conditions"] = Json::object();
  json["paper"] = Json::object();
  for (const RepeatabilityCondition& condition : report.conditions)
    json["conditions"][condition.name] = conditionJson(condition);
  for (const PaperCondition& condition : kPaperTableTwo)
    json["paper"][condition.name] = {{"mean_abs_mm", condition.mean_abs},
                                     {"std_mm", condition.std}};
  json["full_over_none"] = correctedShare(report);
  json["poses"] = report.poses;
  json["visits"] = report.visits;
  json["seed"] = report.seed;
  json["measured_by"] = report.measured_by;
  json["model"] = report.model;
  json["training"] = {{"trajectories", report.training_trajectories},
                      {"pairs", report.training_pairs}};
  json["simulator"] = {{"cycles", report.cycles},
                       {"late_percent", latePercent(report)},
                       {"clock_rate", report.clock_rate}};
  json["folder"] = report.folder;
  return json.dump(1) + "\n";
}

}  // namespace raven_correction
