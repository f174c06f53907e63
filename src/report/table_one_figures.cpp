// SPDX-License-Identifier: BSD-3-Clause
#include "table_one_figures.h"

#include <algorithm>

#include "error_figures.h"
#include "paper_table_one.h"
#include "raven_correction/report/figure_limits.h"
#include "report_json.h"

namespace raven_correction {

const ErrorSummary& meanOfFolds(const TableOneResult& result, const std::string& configuration,
                                Method method, bool clean) {
  return result.row(configuration, method, clean, kMeanOfFolds).errors;
}

std::vector<const TableOneRow*> foldsOf(const TableOneResult& result,
                                        const std::string& configuration, Method method,
                                        bool clean) {
  std::vector<const TableOneRow*> folds;
  for (const TableOneRow& row : result.rows)
    if (row.configuration == configuration && row.method == method && row.clean == clean &&
        row.fold != kMeanOfFolds)
      folds.push_back(&row);
  return folds;
}

double normOf(const ErrorSummary& errors, bool position) {
  return position ? kMillimetre * errors.position_norm : kDegree * errors.angle_norm;
}

std::string configurationLabel(const std::string& name) {
  return "configuration \"" + name + "\", as run here";
}

namespace {

constexpr double kAxisOffset = 0.27;  // between bars of one method [categories]

struct Look {
  Ink ink;
  bool hollow;
};
Look lookOf(std::size_t configuration, std::size_t count) {
  return configuration + 1 == count ? Look{Ink::kBlue, false} : Look{Ink::kOrange, false};
}

/// Norms of all methods, one bar per configuration and one for the paper.
Panel ladderPanel(const TableOneResult& result, bool position, bool clean) {
  const std::vector<std::string> configurations = configurationsOf(result);
  Panel panel;
  panel.title = std::string(position ? "Position" : "Orientation") + ", " +
                (clean ? "clean" : "dirty") + " test set";
  panel.height = 400.0;
  panel.x = Axis("norm of the mean absolute errors", position ? "mm" : "deg");
  for (const Method method : kMethods) panel.y.categories.emplace_back(methodWords(method));
  const std::size_t bars_each = configurations.size() + 1;
  const auto place = [&](std::size_t method, std::size_t bar) {
    return static_cast<double>(method) +
           kAxisOffset * (static_cast<double>(bar) - 0.5 * static_cast<double>(bars_each - 1));
  };
  for (std::size_t c = 0; c < configurations.size(); ++c) {
    // The package's own comes first.
    const std::string& name = configurations[configurations.size() - 1 - c];
    const Look look = lookOf(configurations.size() - 1 - c, configurations.size());
    Bars bars;
    bars.horizontal = true;
    bars.decimals = 2;
    bars.width = 0.9 * kAxisOffset;
    bars.ink = look.ink;
    bars.label = configurationLabel(name) + " (line: lowest and highest fold)";
    for (std::size_t m = 0; m < std::size(kMethods); ++m) {
      bars.position.push_back(place(m, c));
      bars.value.push_back(normOf(meanOfFolds(result, name, kMethods[m], clean), position));
      Range range;
      for (const TableOneRow* row : foldsOf(result, name, kMethods[m], clean))
        range.include(normOf(row->errors, position));
      bars.lower.push_back(range.empty() ? kUnset : range.lower);
      bars.upper.push_back(range.empty() ? kUnset : range.upper);
    }
    panel.layers.push_back(bars);
  }
  Bars paper;
  paper.horizontal = true;
  paper.decimals = 2;
  paper.width = 0.9 * kAxisOffset;
  paper.ink = Ink::kBlack;
  paper.hollow = true;
  paper.label = "as printed in the paper";
  for (std::size_t m = 0; m < std::size(kMethods); ++m) {
    paper.position.push_back(place(m, configurations.size()));
    paper.value.push_back(paperNorm(paperTable(clean), static_cast<int>(m), position ? 0 : 3));
  }
  panel.layers.push_back(paper);
  return panel;
}

}  // namespace

Figure ladderFigure(const TableOneResult& result) {
  Figure figure;
  figure.title = "Six methods, from no correction to everything";
  for (const bool clean : {true, false}) {
    for (const bool position : {true, false})
      figure.panels.push_back(ladderPanel(result, position, clean));
  }
  for (std::size_t k = 0; k < 2; ++k)
    shareLimits({&figure.panels[k], &figure.panels[k + 2]}, true, false);
  figure.how_to_read =
      "Errors of the predicted command on trajectories not used in training: shorter is better. "
      "The "
      "dirty test set holds every observation, the clean one those that a tracker and a robot can "
      "produce. The paper's numbers come from its own recording.";
  figure.good =
      "bars become shorter downwards, and those of the last method are a small part of the first.";
  return figure;
}

Figure distributionFigure(const TableOneResult& result, const ErrorSamples& samples) {
  const std::vector<std::string> configurations = configurationsOf(result);
  const std::string& own = configurations.back();
  std::vector<ErrorCurve> curves{
      {"no correction", Ink::kVermilion, Stroke::kDashed, &samples.find(own, Method::kNone, true)},
      {"rigid step alone", Ink::kGrey, Stroke::kDotted,
       &samples.find(own, Method::kRigidClean, true)}};
  for (std::size_t c = 0; c + 1 < configurations.size(); ++c)
    curves.push_back({"all, " + configurationLabel(configurations[c]), Ink::kOrange,
                      Stroke::kDashed, &samples.find(configurations[c], kFull, true)});
  curves.push_back({"all, " + configurationLabel(own), Ink::kBlue, Stroke::kSolid,
                    &samples.find(own, kFull, true)});
  return errorCurvesFigure(curves);
}

Figure axesFigure(const TableOneResult& result, const ErrorSamples& samples) {
  const std::string own = configurationsOf(result).back();
  return errorAxesFigure(samples.find(own, Method::kNone, true), samples.find(own, kFull, true));
}

Figure foldsFigure(const TableOneResult& result) {
  Figure figure;
  figure.title = "Fold by fold (clean test set, all steps)";
  const std::vector<std::string> configurations = configurationsOf(result);
  for (const bool position : {true, false}) {
    Panel panel;
    panel.title = position ? "Position" : "Orientation";
    panel.height = 240.0;
    panel.x.label = "fold";
    panel.y = Axis("norm of the mean errors", position ? "mm" : "deg");
    panel.y.from_zero = true;
    for (std::size_t c = 0; c < configurations.size(); ++c) {
      const bool own = c + 1 == configurations.size();
      Line line;
      line.label = configurationLabel(configurations[c]);
      line.ink = own ? Ink::kBlue : Ink::kOrange;
      line.stroke = own ? Stroke::kSolid : Stroke::kDashed;
      line.markers = true;
      line.marker = own ? Marker::kSquare : Marker::kCircle;
      for (const TableOneRow* row : foldsOf(result, configurations[c], kFull, true)) {
        line.x.push_back(static_cast<double>(line.x.size()));
        line.y.push_back(normOf(row->errors, position));
        if (c == 0) panel.x.categories.push_back(std::to_string(row->fold));
      }
      panel.layers.push_back(line);
    }
    figure.panels.push_back(panel);
  }
  figure.how_to_read = "Trajectory i is tested in fold i modulo the number of folds.";
  figure.good = "level lines: the result does not hang on which trajectories were left out.";
  return figure;
}

Figure calibrationFigure(const TableOneResult& result, const ErrorSamples& samples) {
  return coverageFigure(
      coverageOf(samples.find(configurationsOf(result).back(), kFull, true).standardised));
}

}  // namespace raven_correction
