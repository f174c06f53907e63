// SPDX-License-Identifier: BSD-3-Clause
#include "raven_correction/report/fidelity_report.h"

#include "raven_correction/error.h"
#include "report_json.h"

namespace raven_correction {
namespace {

std::string intervalText(const LadderValue& value, double scale) {
  return format("%6.2f (%5.2f..%5.2f)", scale * value.value, scale * value.lower,
                scale * value.upper);
}

Json intervalJson(const LadderValue& value, double scale) {
  return Json::array({scale * value.value, scale * value.lower, scale * value.upper});
}

Json ladderJson(const LadderValue& position, const LadderValue& angle) {
  Json json;
  json["position_mm"] = intervalJson(position, kMillimetre);
  json["angle_deg"] = intervalJson(angle, kDegree);
  return json;
}

}  // namespace

std::string fidelitySplit(const FidelityResult& result) {
  const std::string which = format(
      "Figures are of the %zu trajectories i with i %% %d == %d (counted from zero by start time)",
      result.trajectories, result.hold_out.folds, result.hold_out.fold);
  if (result.overlap.independent()) return which + ": the simulation was fitted to none of them.";
  if (result.overlap.known)
    return which + format(": the simulation was fitted to %zu of them, so they flatter it.",
                          result.overlap.seen);
  return which + ": a test of the simulation where it was not fitted to these.";
}

std::string fidelityText(const FidelityResult& result) {
  std::string text =
      fidelitySplit(result) + format("\n\n%-62s %10s %10s\n", "quantity", "measured", "simulated");
  for (const StatisticsRow& row : result.rows)
    text += format("%-62s %10.4g %10.4g %s\n", row.quantity.c_str(), row.measured, row.simulated,
                   row.unit.c_str());
  text += "\nTable I, clean test set, norm of mean absolute errors (95 % over trajectories)\n";
  text += format("%-24s %-22s %-22s %-22s %-22s\n", "method", "measured [mm]", "simulated [mm]",
                 "measured [deg]", "simulated [deg]");
  for (const LadderStep& step : result.ladder)
    text += format("%-24s %s %s %s %s\n", step.method.c_str(),
                   intervalText(step.measured_position, kMillimetre).c_str(),
                   intervalText(step.simulated_position, kMillimetre).c_str(),
                   intervalText(step.measured_angle, kDegree).c_str(),
                   intervalText(step.simulated_angle, kDegree).c_str());
  text += "\nrequired of a simulation of this session\n";
  for (const FidelityCriterion& criterion : result.criteria)
    text += format("%-52s %+8.3f %-5s (within %g)  %s\n", criterion.name.c_str(), criterion.value,
                   criterion.unit.c_str(), criterion.limit, criterion.met() ? "met" : "NOT MET");
  return text;
}

std::string fidelityJson(const FidelityResult& result) {
  Json json;
  json["rows"] = Json::array();
  for (const StatisticsRow& row : result.rows) {
    Json entry;
    entry["quantity"] = row.quantity;
    entry["measured"] = row.measured;
    entry["simulated"] = row.simulated;
    entry["unit"] = row.unit;
    json["rows"].push_back(entry);
  }
  json["ladder"] = Json::array();
  for (const LadderStep& step : result.ladder) {
    Json entry;
    entry["method"] = step.method;
    entry["measured"] = ladderJson(step.measured_position, step.measured_angle);
    entry["simulated"] = ladderJson(step.simulated_position, step.simulated_angle);
    json["ladder"].push_back(entry);
  }
  json["criteria"] = Json::array();
  for (const FidelityCriterion& criterion : result.criteria) {
    Json entry;
    entry["quantity"] = criterion.name;
    entry["value"] = criterion.value;
    entry["limit"] = criterion.limit;
    entry["unit"] = criterion.unit;
    entry["met"] = criterion.met();
    json["criteria"].push_back(entry);
  }
  json["trajectories"] = result.trajectories;
  json["hold_out"] = {{"fold", result.hold_out.fold}, {"folds", result.hold_out.folds}};
  return json.dump(1) + "\n";
}

}  // namespace raven_correction
