// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>

#include "raven_correction/error.h"
#include "raven_correction/report/learning_curve_report.h"
#include "report_json.h"

namespace raven_correction {
namespace {

// Mahler et al. 2014, section V-B: training on 2.5 % of the states and on all of them, 2.7 GHz Core
// i7, Matlab.
constexpr double kPaperPairs[2] = {460.0, 18400.0};
constexpr double kPaperSeconds[2] = {18.6, 4228.8};
constexpr double kEnough[2] = {0.1, 0.1};  // what the paper calls no gain [mm], [deg]

std::vector<const LearningCurveRow*> curveOf(const LearningCurveResult& result) {
  std::vector<const LearningCurveRow*> rows;
  for (const LearningCurveRow& row : result.rows)
    if (row.method == CurveMethod::kRegression) rows.push_back(&row);
  if (rows.empty()) throw InvalidInput("learning curve without a number of pairs");
  return rows;
}

double errorOf(const ErrorSummary& errors, bool position) {
  return position ? kMillimetre * errors.position_norm : kDegree * errors.angle_norm;
}

const ErrorSummary& rigidOf(const LearningCurveResult& result) {
  for (const LearningCurveRow& row : result.rows)
    if (row.method == CurveMethod::kRigid) return row.errors;
  throw InvalidInput("learning curve without the rigid step");
}

/// The first number of pairs after which the curve gains less than kEnough.
std::size_t enoughPairs(const std::vector<const LearningCurveRow*>& rows) {
  for (const LearningCurveRow* row : rows)
    if (errorOf(row->errors, true) - errorOf(rows.back()->errors, true) < kEnough[0] &&
        errorOf(row->errors, false) - errorOf(rows.back()->errors, false) < kEnough[1])
      return row->pairs;
  return rows.back()->pairs;
}

Axis pairsAxis() {
  Axis axis("pairs learnt from", "");
  axis.logarithmic = true;
  return axis;
}

Panel errorPanel(const LearningCurveResult& result, bool position) {
  Panel panel;
  panel.title = position ? "Position" : "Orientation";
  panel.x = pairsAxis();
  panel.y = Axis("norm of the mean absolute errors", position ? "mm" : "deg");
  panel.y.from_zero = true;
  Band band;
  band.label = "lowest to highest fold";
  band.ink = Ink::kSky;
  Line line;
  line.label = "rigid step and Gaussian process";
  line.ink = Ink::kBlue;
  line.markers = true;
  for (const LearningCurveRow* row : curveOf(result)) {
    const auto pairs = static_cast<double>(row->pairs);
    double low = errorOf(row->errors, position), high = low;
    for (const ErrorSummary& fold : row->folds) {
      low = std::min(low, errorOf(fold, position));
      high = std::max(high, errorOf(fold, position));
    }
    band.x.push_back(pairs);
    band.lower.push_back(low);
    band.upper.push_back(high);
    line.x.push_back(pairs);
    line.y.push_back(errorOf(row->errors, position));
  }
  Rule rigid;
  rigid.label = "rigid step alone, from all pairs";
  rigid.value = errorOf(rigidOf(result), position);
  panel.layers = {band, line, rigid};
  return panel;
}

Panel timePanel(const LearningCurveResult& result) {
  Panel panel;
  panel.title = "Time of one training";
  panel.x = pairsAxis();
  panel.y = Axis("time", "s");
  panel.y.logarithmic = true;
  Line own;
  own.label = "this package: cleaning, hyper-parameters and fit";
  own.ink = Ink::kGreen;
  own.markers = true;
  own.marker = Marker::kSquare;
  for (const LearningCurveRow* row : curveOf(result)) {
    own.x.push_back(static_cast<double>(row->pairs));
    own.y.push_back(row->train_seconds);
  }
  Points paper;
  paper.label = "as printed in the paper (Matlab, 2.7 GHz Core i7)";
  paper.ink = Ink::kVermilion;
  paper.marker = Marker::kDiamond;
  paper.size = 5.0;
  paper.x.assign(std::begin(kPaperPairs), std::end(kPaperPairs));
  paper.y.assign(std::begin(kPaperSeconds), std::end(kPaperSeconds));
  panel.layers = {own, paper};
  return panel;
}

}  // namespace

std::string learningCurveHtml(const LearningCurveResult& result, const RunRecord& run) {
  const std::vector<const LearningCurveRow*> rows = curveOf(result);
  HtmlDocument document("How much data the correction needs",
                        "Errors on motions left out, and the time of training, against the number "
                        "of training pairs (Fig. 5 of Mahler et al. 2014).");
  const LearningCurveRow& last = *rows.back();
  const std::size_t enough = enoughPairs(rows);
  const bool saturated = enough < last.pairs;
  document.verdict(
      saturated ? Tone::kGood : Tone::kNotice,
      saturated ? format("Beyond %zu pairs less than 0.1 mm and 0.1 deg is gained.", enough)
                : format("The error still falls at %zu pairs.", last.pairs),
      {format("%zu pairs leave %.2f mm and %.2f deg; training on them takes %.1f s.", last.pairs,
              errorOf(last.errors, true), errorOf(last.errors, false), last.train_seconds),
       format("The rigid step alone leaves %.2f mm and %.2f deg.", errorOf(rigidOf(result), true),
              errorOf(rigidOf(result), false)),
       "The paper: beyond 460 states less than 0.1 mm and 0.1 deg is gained."},
      {saturated ? "More motions of the same kind will not help; record where the task goes that "
                   "training did not."
                 : "Record more motions, or try larger numbers (--states)."});
  Figure figure;
  figure.title = "Error and time of training against the number of training pairs";
  figure.panels = {errorPanel(result, true), errorPanel(result, false), timePanel(result)};
  figure.how_to_read = format(
      "Pairs are drawn at random from the motions that the fold does not test on; clean test "
      "states, %zu motions left out in all. Horizontal axes are logarithmic.",
      result.trajectories);
  figure.good = "the curves become flat well below the dashed line, and the band is narrow.";
  document.section("Curves");
  document.figure(figure);
  HtmlTable table;
  table.caption = "The same in numbers: means over folds.";
  table.header = {"pairs",       "position [mm]", "orientation [deg]",
                  "median [mm]", "95 % [mm]",     "training [s]"};
  table.numeric.assign(table.header.size(), true);
  for (const LearningCurveRow* row : rows)
    table.rows.push_back({std::to_string(row->pairs), format("%.2f", errorOf(row->errors, true)),
                          format("%.2f", errorOf(row->errors, false)),
                          format("%.2f", kMillimetre * row->errors.position_median),
                          format("%.2f", kMillimetre * row->errors.position_p95),
                          format("%.2f", row->train_seconds)});
  document.table(table);
  appendProvenance(run, document);
  return document.text();
}

}  // namespace raven_correction
