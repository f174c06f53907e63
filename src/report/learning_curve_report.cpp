// SPDX-License-Identifier: BSD-3-Clause
#include "raven_correction/report/learning_curve_report.h"

#include <cmath>

#include "raven_correction/error.h"
#include "report_json.h"

namespace raven_correction {
namespace {

std::string pairsText(double pairs, std::size_t fewest, std::size_t most) {
  if (std::isinf(pairs)) return format("> %zu", most);
  if (pairs == 0.0) return format("< %zu", fewest);
  return format("%.0f", pairs);
}

Json pairsJson(double pairs) { return std::isinf(pairs) ? Json(nullptr) : Json(pairs); }

}  // namespace

std::string learningCurveText(const LearningCurveResult& result) {
  std::string text = format(
      "%zu trajectories held out; clean states; means over folds (in brackets: lowest and "
      "highest)\n\n"
      "%-20s %6s   %-24s %8s %8s   %-24s %8s\n",
      result.trajectories, "method", "pairs", "position [mm], norm MAE", "median", "p95",
      "angle [deg], norm MAE", "train [s]");
  for (const LearningCurveRow& row : result.rows) {
    double low_position = 1e9, high_position = 0.0, low_angle = 1e9, high_angle = 0.0;
    for (const ErrorSummary& fold : row.folds) {
      low_position = std::min(low_position, kMillimetre * fold.position_norm);
      high_position = std::max(high_position, kMillimetre * fold.position_norm);
      low_angle = std::min(low_angle, kDegree * fold.angle_norm);
      high_angle = std::max(high_angle, kDegree * fold.angle_norm);
    }
    const std::string pairs = row.pairs > 0 ? format("%zu", row.pairs) : std::string("-");
    const std::string seconds =
        row.pairs > 0 ? format("%.2f", row.train_seconds) : std::string("-");
    text +=
        format("%-20s %6s   %6.2f (%5.2f..%5.2f)     %8.2f %8.2f   %6.2f (%5.2f..%5.2f)     %8s\n",
               curveMethodName(row.method), pairs.c_str(), kMillimetre * row.errors.position_norm,
               low_position, high_position, kMillimetre * row.errors.position_median,
               kMillimetre * row.errors.position_p95, kDegree * row.errors.angle_norm, low_angle,
               high_angle, seconds.c_str());
  }
  if (result.saved.empty()) return text;
  text += format(
      "\nerror with physics over error of regression alone, same pairs (95 %% over trajectories),\n"
      "and the pairs with which regression alone is as good\n\n%6s   %-22s %-22s %10s %10s\n",
      "pairs", "position", "angle", "position", "angle");
  for (const PairsSaved& saved : result.saved) {
    const std::size_t fewest = result.saved.front().pairs, most = result.saved.back().pairs;
    text += format("%6zu   %.3f (%.3f..%.3f)   %.3f (%.3f..%.3f)   %10s %10s\n", saved.pairs,
                   saved.position_ratio, saved.position_lower, saved.position_upper,
                   saved.angle_ratio, saved.angle_lower, saved.angle_upper,
                   pairsText(saved.position_pairs, fewest, most).c_str(),
                   pairsText(saved.angle_pairs, fewest, most).c_str());
  }
  if (result.simulations.size() == 1)
    text += format(
        "\none simulation (%s) for all folds: the figures of physics are honest only for "
        "trajectories that it was not fitted to\n",
        result.simulations.front().c_str());
  if (result.out_of_reach > 0)
    text += format("%zu training pairs (all folds) are out of its reach and were not learnt from\n",
                   result.out_of_reach);
  return text;
}

std::string learningCurveJson(const LearningCurveResult& result) {
  Json json;
  json["rows"] = Json::array();
  for (const LearningCurveRow& row : result.rows) {
    Json entry = {{"method", curveMethodName(row.method)},
                  {"pairs", row.pairs},
                  {"n_train", row.n_train},
                  {"n_test", row.errors.n},
                  {"position_norm_mm", kMillimetre * row.errors.position_norm},
                  {"position_median_mm", kMillimetre * row.errors.position_median},
                  {"position_p95_mm", kMillimetre * row.errors.position_p95},
                  {"angle_norm_deg", kDegree * row.errors.angle_norm},
                  {"angle_mean_deg", kDegree * row.errors.angle_mean},
                  {"train_seconds", row.train_seconds}};
    for (const ErrorSummary& fold : row.folds) {
      entry["fold_position_norm_mm"].push_back(kMillimetre * fold.position_norm);
      entry["fold_angle_norm_deg"].push_back(kDegree * fold.angle_norm);
    }
    json["rows"].push_back(entry);
  }
  json["saved"] = Json::array();
  for (const PairsSaved& saved : result.saved)
    json["saved"].push_back(
        {{"pairs", saved.pairs},
         {"position_ratio", saved.position_ratio},
         {"position_ratio_interval", {saved.position_lower, saved.position_upper}},
         {"angle_ratio", saved.angle_ratio},
         {"angle_ratio_interval", {saved.angle_lower, saved.angle_upper}},
         {"regression_pairs_position", pairsJson(saved.position_pairs)},
         {"regression_pairs_angle", pairsJson(saved.angle_pairs)}});
  json["trajectories"] = result.trajectories;
  json["out_of_reach"] = result.out_of_reach;
  json["simulations"] = result.simulations;
  return json.dump(1) + "\n";
}

}  // namespace raven_correction
