// SPDX-License-Identifier: BSD-3-Clause
#include "raven_correction/report/debridement_report.h"

#include <cmath>

#include "debridement_words.h"
#include "raven_correction/error.h"
#include "report_json.h"

namespace raven_correction {
namespace {

Json intervalJson(const Interval& interval, double scale = 1.0) {
  return Json::array({scale * interval.lower, scale * interval.upper});
}

Json sceneJson(const ClearedField& field) {
  return {{"seed", field.seed},           {"fragments", field.fragments},
          {"delivered", field.delivered}, {"seconds", field.seconds},
          {"missed", field.missed},       {"dropped", field.dropped}};
}

Json conditionJson(const DebridementCondition& condition, std::uint64_t seed) {
  const DebridementSummary s = summarise(condition.fields, seed);
  Json json;
  json["seconds_per_fragment"] = s.seconds_per_fragment;
  json["seconds_per_fragment_interval"] = intervalJson(s.seconds_interval);
  json["success_percent"] = kPercent * s.success;
  json["success_percent_interval"] = intervalJson(s.success_interval, kPercent);
  json["fragments"] = s.fragments;
  json["delivered"] = s.delivered;
  json["given_up"] = s.given_up;
  json["attempts"] = s.attempts;
  json["retries_per_fragment"] = s.retries;
  json["first_try_percent"] = kPercent * firstTryShare(s);
  json["missed_grasps"] = s.missed;
  json["dropped"] = s.dropped;
  json["replans"] = s.replans;
  json["arm_seconds_per_fragment"] = s.busy_per_fragment;
  json["seconds"] = s.seconds;
  json["waited_seconds"] = s.waited;
  json["speed_cm_per_s"] = 100.0 * condition.speed;
  json["replan_interval_s"] = condition.replan_interval;
  json["deviation_limit_mm"] = condition.deviation_limit < 0.0
                                   ? Json(nullptr)
                                   : Json(kMillimetre * condition.deviation_limit);
  json["smallest_distance_mm"] =
      std::isfinite(condition.clearance) ? Json(kMillimetre * condition.clearance) : Json(nullptr);
  const CorrectedPoses& poses = condition.poses;
  const auto share = [&](std::uint64_t part) {
    return poses.all == 0 ? Json(nullptr) : Json(percentOf(part, poses.all));
  };
  json["poses"] = poses.all;
  json["poses_corrected_percent"] = share(poses.corrected);
  json["poses_reduced_percent"] = share(poses.reduced);
  json["scenes"] = Json::array();
  for (const ClearedField& field : condition.fields) json["scenes"].push_back(sceneJson(field));
  return json;
}

void addComparison(const DebridementReport& report, const char* fast, const std::string& of,
                   Json& json) {
  if (const std::optional<PairedComparison> speed_up = speedUpOf(report, fast)) {
    json["speedup" + of] = speed_up->value;
    json["speedup" + of + "_interval"] = intervalJson(speed_up->interval);
  }
  if (const std::optional<PairedComparison> success = successOf(report, fast)) {
    json["success_difference" + of + "_percent"] = kPercent * success->value;
    json["success_difference" + of + "_interval_percent"] =
        intervalJson(success->interval, kPercent);
  }
}

}  // namespace

std::string debridementText(const DebridementReport& report) {
  std::string text = format(
      "Debridement (section V-D): fragments of foam on an 8 x 8 cm field, %u %s, the same scenes "
      "in "
      "every condition\nsimulated time; a fragment is given up after %u attempts; intervals: 95 "
      "%%, "
      "bootstrap over scenes\n\n  %-36s",
      report.arms, report.arms == 1 ? "arm" : "arms", report.attempts, "");
  for (const DebridementCondition& condition : report.conditions)
    text += format("  %-22s", condition.name.c_str());
  text += "\n";
  std::vector<DebridementSummary> summaries;
  for (const DebridementCondition& condition : report.conditions)
    summaries.push_back(summarise(condition.fields, report.seed));
  for (const DebridementRow& row : debridementRows()) {
    text += format("  %-36s", row.name);
    for (std::size_t i = 0; i < summaries.size(); ++i)
      text += format("  %-22s", row.value(report.conditions[i], summaries[i]).c_str());
    text += "\n";
  }
  text += "\n";
  for (const char* fast : {kCorrected, kCorrectedReplanning}) {
    if (const std::optional<PairedComparison> speed_up = speedUpOf(report, fast))
      text += format("  %-22s %.2f times faster than the baseline (%.2f to %.2f)\n", fast,
                     speed_up->value, speed_up->interval.lower, speed_up->interval.upper);
    if (const std::optional<PairedComparison> success = successOf(report, fast))
      text += format("  %-22s success %+.1f points (%+.1f to %+.1f): %s\n", "",
                     kPercent * success->value, kPercent * success->interval.lower,
                     kPercent * success->interval.upper, successWords(*success));
  }
  text += format("  %-22s %.1f times faster, %.1f s per fragment\n", "the paper", kPaperSpeedUp,
                 kPaperSecondsPerFragment);
  for (const DebridementLearning& arm : report.learning)
    text += format(
        "  %s: learnt from %u pairs at %u places; on held-out motions %.1f to %.2f mm, %.1f to "
        "%.2f deg; at %u places like those of the task %.2f mm off, medians (%.2f, %.2f, %.2f) mm, "
        "by "
        "motion capture; sd predicted at three in four of them at most %.2f mm\n",
        arm.arm.c_str(), arm.pairs, arm.places, arm.before_mm, arm.after_mm, arm.before_deg,
        arm.after_deg, arm.trial_places, kMillimetre * arm.trial_deviation,
        kMillimetre * arm.trial_median.x(), kMillimetre * arm.trial_median.y(),
        kMillimetre * arm.trial_median.z(), kMillimetre * arm.usual_prediction);
  text += format(
      "  simulator: %llu cycles, %.1f %% of them late, %.2f simulated seconds per second; the "
      "clock "
      "stood for %.0f s while pictures were drawn and searched, each counts %.1f s\n",
      static_cast<unsigned long long>(report.cycles), latePercent(report), report.clock_rate,
      report.stood, report.look_time);
  if (!report.folder.empty()) text += "  bags, models and log: " + report.folder + "\n";
  return text;
}

std::string debridementJson(const DebridementReport& report) {
  Json json;
  for (const DebridementCondition& condition : report.conditions)
    json[condition.name] = conditionJson(condition, report.seed);
  addComparison(report, kCorrected, "", json);
  addComparison(report, kCorrectedReplanning, "_replanning", json);
  json["paper"] = {{"speedup", kPaperSpeedUp},
                   {"corrected", {{"seconds_per_fragment", kPaperSecondsPerFragment}}}};
  json["arms"] = report.arms;
  json["attempts_per_fragment"] = report.attempts;
  json["seed"] = report.seed;
  json["look_seconds"] = report.look_time;
  json["training"] = Json::array();
  for (const DebridementLearning& arm : report.learning)
    json["training"].push_back(
        {{"arm", arm.arm},
         {"model", arm.model},
         {"places", arm.places},
         {"pairs", arm.pairs},
         {"position_before_mm", arm.before_mm},
         {"position_after_mm", arm.after_mm},
         {"angle_before_deg", arm.before_deg},
         {"angle_after_deg", arm.after_deg},
         {"trial_places", arm.trial_places},
         {"trial_deviation_mm", kMillimetre * arm.trial_deviation},
         {"trial_median_mm",
          {kMillimetre * arm.trial_median.x(), kMillimetre * arm.trial_median.y(),
           kMillimetre * arm.trial_median.z()}},
         {"usual_prediction_mm", kMillimetre * arm.usual_prediction}});
  json["simulator"] = {{"cycles", report.cycles},
                       {"late_percent", latePercent(report)},
                       {"clock_rate", report.clock_rate},
                       {"stood_seconds", report.stood}};
  json["folder"] = report.folder;
  return json.dump(1) + "\n";
}

}  // namespace raven_correction
