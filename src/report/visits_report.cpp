// SPDX-License-Identifier: BSD-3-Clause
#include "raven_correction/report/visits_report.h"

#include <algorithm>

#include "raven_correction/error.h"
#include "report_json.h"

namespace raven_correction {
namespace {

double worst(const std::vector<Visit>& visits, std::string& name) {
  double largest = -1.0;
  for (const Visit& visit : visits) {
    const double error = visit.error.components.head<3>().norm();
    if (error > largest) {
      largest = error;
      name = visit.name;
    }
  }
  return largest;
}

Json summaryJson(const ErrorSummary& summary) {
  return {{"position_norm_mm", kMillimetre * summary.position_norm},
          {"angle_norm_deg", kDegree * summary.angle_norm},
          {"mean_abs", componentsJson(summary.mean_abs)},
          {"std", componentsJson(summary.std)},
          {"position_median_mm", kMillimetre * summary.position_median},
          {"position_p95_mm", kMillimetre * summary.position_p95}};
}

}  // namespace

std::string visitsText(const VisitComparison& comparison) {
  const ErrorSummary& before = comparison.summary_before;
  const ErrorSummary& after = comparison.summary_after;
  std::string text = format(
      "Resting error at %zu targets: mean +- standard deviation of |target - observed|\n\n"
      "                    before           after   after/before\n",
      comparison.before.size());
  for (int v = 0; v < 6; ++v)
    text += format("  %-5s %-4s  %6.2f +- %-6.2f %6.2f +- %-6.2f %6.3f\n", kVariables[v],
                   unitName(v), unitOf(v) * before.mean_abs(v), unitOf(v) * before.std(v),
                   unitOf(v) * after.mean_abs(v), unitOf(v) * after.std(v),
                   after.mean_abs(v) / before.mean_abs(v));
  text += format("  norm  mm    %6.2f           %6.2f           %6.3f\n",
                 kMillimetre * before.position_norm, kMillimetre * after.position_norm,
                 after.position_norm / before.position_norm);
  text +=
      format("  norm  deg   %6.2f           %6.2f           %6.3f\n", kDegree * before.angle_norm,
             kDegree * after.angle_norm, after.angle_norm / before.angle_norm);
  std::string worst_before, worst_after;
  const double largest_before = worst(comparison.before, worst_before);
  const double largest_after = worst(comparison.after, worst_after);
  text += format("  worst mm    %6.2f (%s)    %6.2f (%s)\n", kMillimetre * largest_before,
                 worst_before.c_str(), kMillimetre * largest_after, worst_after.c_str());
  for (const std::string& name : comparison.skipped)
    text += format("  skipped: %s (only in one recording, or not seen at rest)\n", name.c_str());
  return text;
}

std::string visitsJson(const VisitComparison& comparison, const std::string& bag,
                       const std::string& model) {
  Json json;
  json["before"] = summaryJson(comparison.summary_before);
  json["after"] = summaryJson(comparison.summary_after);
  json["targets"] = comparison.before.size();
  json["skipped"] = comparison.skipped;
  json["bag"] = bag;
  json["model"] = model;
  return json.dump(1) + "\n";
}

}  // namespace raven_correction
