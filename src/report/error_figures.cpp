// SPDX-License-Identifier: BSD-3-Clause
#include "error_figures.h"

#include "paper_table_one.h"
#include "raven_correction/report/figure_limits.h"
#include "report_json.h"

namespace raven_correction {
namespace {

constexpr double kShown = 0.98;  // share of the points that an axis has room for [-]

std::vector<double> scaled(std::vector<double> values, double factor) {
  for (double& value : values) value *= factor;
  return values;
}

Panel axesPanel(const ErrorSeries& series, bool position, bool before) {
  Panel panel;
  panel.title =
      std::string(position ? "Position" : "Orientation") + ", " + (before ? "before" : "after");
  panel.height = 260.0;
  panel.y = Axis("true minus predicted command", position ? "mm" : "deg");
  Boxes boxes;
  boxes.label = before ? "no correction" : "all steps";
  boxes.ink = before ? Ink::kVermilion : Ink::kBlue;
  boxes.hollow = before;
  for (int v = position ? 0 : 3; v < (position ? 3 : 6); ++v) {
    panel.x.categories.emplace_back(kVariables[v]);
    std::vector<double> values;
    for (const auto& components : series.components) values.push_back(unitOf(v) * components(v));
    boxes.position.push_back(static_cast<double>(boxes.position.size()));
    boxes.quantiles.push_back(quantilesOf(values));
  }
  panel.layers.push_back(boxes);
  return panel;
}

}  // namespace

Figure errorCurvesFigure(const std::vector<ErrorCurve>& curves) {
  Figure figure;
  figure.title = "How large the errors are (clean test set)";
  for (const bool position : {true, false}) {
    Panel panel;
    panel.title = position ? "Position" : "Orientation";
    panel.x =
        Axis(position ? "length of the error" : "angle of the error", position ? "mm" : "deg");
    panel.x.logarithmic = true;
    panel.y = Axis("test states with at most this error", "%");
    panel.y.lower = 0.0;
    panel.y.upper = 100.0;
    std::vector<double> all;
    for (const ErrorCurve& curve : curves) {
      const std::vector<double> values =
          scaled(position ? curve.series->position : curve.series->angle,
                 position ? kMillimetre : kDegree);
      all.insert(all.end(), values.begin(), values.end());
      Line line = cumulativeOf(values);
      line.label = curve.label;
      line.ink = curve.ink;
      line.stroke = curve.stroke;
      panel.layers.push_back(line);
    }
    limitTo(panel.x, all, kShown);
    figure.panels.push_back(panel);
  }
  figure.how_to_read =
      "Each curve says which share of the test states has an error of at most what the horizontal "
      "axis says (logarithmic); where it crosses 50 % is the median.";
  figure.good = "the solid curve lies far to the left of the others over its whole height.";
  return figure;
}

Figure errorAxesFigure(const ErrorSeries& before, const ErrorSeries& after) {
  Figure figure;
  figure.title = "Errors per axis, before and after (clean test set)";
  for (const bool position : {true, false}) {
    Panel pair[2] = {axesPanel(before, position, true), axesPanel(after, position, false)};
    shareLimits({&pair[0], &pair[1]}, false, true);
    figure.panels.insert(figure.panels.end(), {pair[0], pair[1]});
  }
  figure.how_to_read =
      "Position in the base frame; yaw, pitch, roll of the remaining rotation. Line: 5 % to 95 % "
      "of "
      "the test states; box: the middle half; bar across: the median. Before and after have the "
      "same limits.";
  figure.good = "after, the boxes are small and centred on zero.";
  return figure;
}

Figure coverageFigure(const CoverageCurve& curve) {
  static constexpr Ink kInks[3] = {Ink::kBlue, Ink::kGreen, Ink::kPurple};
  static constexpr Marker kMarks[3] = {Marker::kCircle, Marker::kSquare, Marker::kTriangle};
  static constexpr Stroke kStrokes[3] = {Stroke::kSolid, Stroke::kDashed, Stroke::kDotted};
  Figure figure;
  figure.title = "Are the predicted intervals as wide as the errors?";
  for (const int first : {0, 3}) {
    Panel panel;
    panel.title = first == 0 ? "Position (dx dy dz)" : "Orientation (rx ry rz)";
    panel.x = Axis("probability that the interval claims", "%");
    panel.y = Axis("true values inside it", "%");
    panel.x.lower = panel.y.lower = 0.0;
    panel.x.upper = panel.y.upper = 100.0;
    Line ideal;
    ideal.label = "exactly right";
    ideal.ink = Ink::kGrey;
    ideal.x = ideal.y = {0.0, 100.0};
    panel.layers.push_back(ideal);
    for (int v = first; v < first + 3; ++v) {
      Line line;
      line.label = kOutputs[v];
      line.ink = kInks[v - first];
      line.stroke = kStrokes[v - first];
      line.markers = true;
      line.marker = kMarks[v - first];
      for (std::size_t k = 0; k < curve.nominal.size(); ++k) {
        line.x.push_back(kPercent * curve.nominal[k]);
        line.y.push_back(kPercent * curve.observed(static_cast<Eigen::Index>(k), v));
      }
      panel.layers.push_back(line);
    }
    figure.panels.push_back(panel);
  }
  figure.how_to_read =
      "Central intervals of many widths about each predicted command, clean test set: the share of "
      "true commands inside, against the probability that the interval claims. Above the grey line "
      "the intervals are wider than needed, below it they promise too much.";
  figure.good = "the curves follow the grey line, and above all do not fall below it at the right.";
  return figure;
}

}  // namespace raven_correction
