// SPDX-License-Identifier: BSD-3-Clause
#include "raven_correction/report/fidelity_html.h"

#include <algorithm>
#include <cmath>

#include "health_html.h"
#include "raven_correction/error.h"
#include "raven_correction/report/fidelity_report.h"
#include "raven_correction/report/figure_limits.h"
#include "report_json.h"

namespace raven_correction {
namespace {

constexpr char kMeasured[] = "measured", kSimulated[] = "simulated";

Figure criteriaFigure(const FidelityResult& result) {
  Figure figure;
  figure.title = "How far each figure is from the measured one, in shares of what is allowed";
  figure.columns = 1;
  Panel panel;
  panel.width = 460.0;
  panel.height = 70.0 + 24.0 * static_cast<double>(result.criteria.size());
  panel.x = Axis("simulated against measured, over its limit", "%");
  Bars bars;
  bars.horizontal = true;
  bars.decimals = 0;
  bars.ink = Ink::kSky;
  for (const FidelityCriterion& criterion : result.criteria) {
    panel.y.categories.push_back((criterion.met() ? "\xE2\x9C\x93 " : "\xE2\x9C\x97 ") +
                                 criterion.name);
    bars.position.push_back(static_cast<double>(bars.position.size()));
    bars.value.push_back(criterion.limit > 0.0 ? kPercent * criterion.value / criterion.limit
                                               : criterion.value);
  }
  panel.layers.push_back(bars);
  for (const double limit : {-kPercent, kPercent}) {
    Rule rule;
    rule.label = "limit";
    rule.vertical = true;
    rule.value = limit;
    panel.layers.push_back(rule);
  }
  figure.panels.push_back(panel);
  figure.how_to_read =
      "0 % is exactly like the measured session; between the dashed lines the requirement is met.";
  figure.good = "all bars stay well inside the dashed lines.";
  return figure;
}

Figure ladderFigure(const FidelityResult& result) {
  Figure figure;
  figure.title = "Table I on the measured and on the simulated session (clean test set)";
  for (const bool position : {true, false}) {
    Panel panel;
    panel.title = position ? "Position" : "Orientation";
    panel.height = 330.0;
    panel.x = Axis("norm of the mean absolute errors", position ? "mm" : "deg");
    for (const bool measured : {true, false}) {
      Bars bars;
      bars.horizontal = true;
      bars.decimals = 2;
      bars.width = 0.36;
      bars.hollow = measured;
      bars.ink = measured ? Ink::kVermilion : Ink::kBlue;
      bars.label = std::string(measured ? kMeasured : kSimulated) +
                   ", with its 95 % interval over trajectories";
      for (std::size_t i = 0; i < result.ladder.size(); ++i) {
        const LadderStep& step = result.ladder[i];
        const LadderValue& value =
            position ? (measured ? step.measured_position : step.simulated_position)
                     : (measured ? step.measured_angle : step.simulated_angle);
        const double scale = position ? kMillimetre : kDegree;
        if (measured) panel.y.categories.push_back(step.method);
        bars.position.push_back(static_cast<double>(i) + (measured ? -0.2 : 0.2));
        bars.value.push_back(scale * value.value);
        bars.lower.push_back(scale * value.lower);
        bars.upper.push_back(scale * value.upper);
      }
      panel.layers.push_back(bars);
    }
    figure.panels.push_back(panel);
  }
  figure.how_to_read =
      "Errors of every method when it is trained and tested on the measured session, and when it "
      "is "
      "trained and tested on the simulated one.";
  figure.good = "both bars of a method are alike, and the methods rank in the same order.";
  return figure;
}

void appendRows(const FidelityResult& result, HtmlDocument& document) {
  HtmlTable table;
  table.caption = "The same figures of both sessions.";
  table.header = {"quantity", kMeasured, kSimulated, "unit"};
  table.numeric = {false, true, true, false};
  for (const StatisticsRow& row : result.rows)
    table.rows.push_back(
        {row.quantity, format("%.4g", row.measured), format("%.4g", row.simulated), row.unit});
  document.table(table);
}

}  // namespace

std::string fidelityHtml(const FidelityResult& result, const std::vector<StreamHealth>& streams,
                         const RunRecord& run) {
  HtmlDocument document("Fidelity of the simulation",
                        "How like the measured session the simulated one is, on a part of its "
                        "trajectories.");
  std::vector<std::string> found{fidelitySplit(result)};
  for (const FidelityCriterion& criterion : result.criteria)
    if (!criterion.met())
      found.push_back(format("%s: %+.3f %s, allowed is %g.", criterion.name.c_str(),
                             criterion.value, criterion.unit.c_str(), criterion.limit));
  const std::size_t met = result.criteria.size() - (found.size() - 1);
  const bool all_met = met == result.criteria.size();
  std::vector<std::string> next;
  if (all_met)
    next.emplace_back("Use the simulation to try planners and trainers before the robot.");
  else
    next.emplace_back(
        "Find what is missing (diagnose INPUT --simulation S -o extended.yaml), and "
        "compare again with the extended simulation.");
  document.verdict(all_met ? Tone::kGood : Tone::kWarning,
                   format("%zu of %zu requirements are met on %zu trajectories.", met,
                          result.criteria.size(), result.trajectories),
                   found, next);
  document.section("Requirements");
  HtmlTable table;
  table.caption = "Simulated against measured: a ratio minus one, or a difference.";
  table.header = {"quantity", "value", "limit", "unit", "met"};
  table.numeric = {false, true, true, false, false};
  for (const FidelityCriterion& criterion : result.criteria)
    table.rows.push_back({criterion.name, format("%+.3f", criterion.value),
                          format("%g", criterion.limit), criterion.unit,
                          criterion.met() ? "met" : "NOT MET"});
  document.table(table);
  document.figure(criteriaFigure(result));
  document.section("Table I");
  document.figure(ladderFigure(result));
  document.section("All figures");
  appendRows(result, document);
  document.section("Data health");
  appendStreams(streams, document);
  appendProvenance(run, document);
  return document.text();
}

}  // namespace raven_correction
