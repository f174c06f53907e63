// SPDX-License-Identifier: BSD-3-Clause
#include "diagnosis_figures.h"

#include <algorithm>
#include <cmath>

#include "diagnosis_panels.h"
#include "diagnosis_words.h"
#include "raven_correction/error.h"
#include "raven_correction/report/figure_limits.h"
#include "report_json.h"

namespace raven_correction {
namespace {

constexpr int kCells = 8;  // of either side of the workspace

/// Lengths of the columns of some rows.
std::vector<double> lengths(const Eigen::MatrixXd& values, Eigen::Index first, double scale) {
  std::vector<double> out;
  for (Eigen::Index i = 0; i < values.cols(); ++i)
    out.push_back(scale * values.col(i).segment<3>(first).norm());
  return out;
}

Line cumulative(const std::vector<double>& values, const std::string& label, Ink ink,
                Stroke stroke) {
  Line line = cumulativeOf(values);
  line.label = label;
  line.ink = ink;
  line.stroke = stroke;
  return line;
}

Rule floorRule(const std::string& label, double value) {
  Rule floor;
  floor.label = label;
  floor.value = value;
  floor.vertical = true;
  floor.stroke = Stroke::kDotted;
  return floor;
}

/// Axes of a cumulative figure with room for all curves and the floor; errors span decades.
void layOutDistribution(const std::vector<double>& all, double floor, Panel& panel) {
  panel.x.logarithmic = true;
  limitTo(panel.x, all, kShown);
  if (floor > 0.0 && floor < panel.x.lower) panel.x.lower = floor / 1.2;
  panel.y = Axis("samples with at most this error", "%");
  panel.y.lower = 0.0;
  panel.y.upper = 100.0;
  if (floor > 0.0) panel.layers.push_back(floorRule("noise floor (RMS)", floor));
}

Panel distributionPanel(const Verdict& verdict, bool position) {
  const double scale = position ? kMillimetre : kDegree;
  const Eigen::Index first = position ? 0 : 3;
  const ResidualSamples& samples = verdict.figures;
  Panel panel;
  panel.title = position ? "Position" : "Orientation";
  panel.x.label = position ? "length of the error" : "angle of the error";
  panel.x.unit = position ? "mm" : "deg";
  std::vector<double> all = lengths(samples.before.tool, first, scale);
  const std::vector<double> after = lengths(samples.after.tool, first, scale);
  panel.layers.push_back(cumulative(all, kBefore, kInkBefore, Stroke::kDashed));
  if (samples.aligned.tool.size() > 0)
    panel.layers.push_back(cumulative(lengths(samples.aligned.tool, first, scale),
                                      "registration and tool frame alone", Ink::kGrey,
                                      Stroke::kDotted));
  panel.layers.push_back(cumulative(after, kAfter, kInkAfter, Stroke::kSolid));
  all.insert(all.end(), after.begin(), after.end());
  layOutDistribution(all, scale * (position ? verdict.noise_floor : verdict.angle_floor), panel);
  return panel;
}

Panel jointDistributionPanel(const Verdict& verdict, std::size_t joint) {
  const JointUnit unit = unitOfJoint(verdict, joint);
  const auto r = static_cast<Eigen::Index>(joint);
  Panel panel;
  panel.title = verdict.joints[joint];
  panel.x.label = "size of the error";
  panel.x.unit = unit.name;
  std::vector<double> all;
  for (const Side& side : sidesOf(verdict)) {
    std::vector<double> values = rowOf(side.residual.joints, r, unit.scale);
    for (double& value : values) value = std::abs(value);
    all.insert(all.end(), values.begin(), values.end());
    panel.layers.push_back(cumulative(values, side.before ? kBefore : kAfter, side.ink,
                                      side.before ? Stroke::kDashed : Stroke::kSolid));
  }
  layOutDistribution(
      all, joint < verdict.joint_floor.size() ? unit.scale * verdict.joint_floor[joint] : 0.0,
      panel);
  return panel;
}

/// Quantile strips of some rows of the residual, one panel.
Panel stripsPanel(const std::vector<std::string>& names, const std::vector<std::vector<double>>& of,
                  const Side& side, const Axis& value_axis, const std::string& what) {
  Panel panel;
  panel.title = what + ", " + side.title;
  panel.x.categories = names;
  panel.y = value_axis;
  Boxes boxes;
  boxes.label = side.before ? kBefore : kAfter;
  boxes.ink = side.ink;
  boxes.hollow = side.before;
  for (std::size_t i = 0; i < of.size(); ++i) {
    boxes.position.push_back(static_cast<double>(i));
    boxes.quantiles.push_back(quantilesOf(of[i]));
  }
  panel.layers.push_back(boxes);
  panel.height = 260.0;
  return panel;
}

}  // namespace

Figure errorDistributionFigure(const Verdict& verdict) {
  Figure figure;
  figure.title = "How large the errors are, before and after";
  if (verdict.has_kinematics) {
    figure.panels = {distributionPanel(verdict, true), distributionPanel(verdict, false)};
  } else {
    for (std::size_t j = 0; j < verdict.joints.size(); ++j)
      figure.panels.push_back(jointDistributionPanel(verdict, j));
  }
  figure.how_to_read =
      "Measured minus simulated. Each curve says which share of the samples has an error of at "
      "most what the horizontal axis says (logarithmic); where it crosses 50 % is the median. The "
      "after curve is of motions held out: none was predicted with parameters fitted to it (the "
      "causes themselves, and the instant of a registration shift, were chosen with all motions in "
      "view).";
  figure.good =
      "the solid curve climbs far to the left of the dashed one, and reaches the noise floor.";
  return figure;
}

Figure toolAxesFigure(const Verdict& verdict) {
  Figure figure;
  figure.title = "Error of the tool per axis";
  for (const bool position : {true, false}) {
    Axis axis;
    axis.label = "measured minus simulated";
    axis.unit = position ? "mm" : "deg";
    for (const Side& side : sidesOf(verdict)) {
      std::vector<std::vector<double>> rows;
      for (Eigen::Index k = 0; k < 3; ++k)
        rows.push_back(
            rowOf(side.residual.tool, k + (position ? 0 : 3), position ? kMillimetre : kDegree));
      figure.panels.push_back(
          stripsPanel(position ? std::vector<std::string>{"x", "y", "z"}
                               : std::vector<std::string>{"about x", "about y", "about z"},
                      rows, side, axis, position ? "Position" : "Orientation"));
    }
    shareLimits(pointers(figure.panels, figure.panels.size() - 2, 2), false, true);
  }
  figure.how_to_read =
      "Position in the base frame, orientation as a rotation vector in the frame of the simulated "
      "tool. Line: 5 % to 95 % of the samples; box: the middle half; bar across: the median. Left "
      "and right have the same limits.";
  figure.good =
      "after, the boxes are small and their medians lie at zero: what is left is no bias.";
  return figure;
}

Figure jointAxesFigure(const Verdict& verdict) {
  Figure figure;
  figure.title =
      verdict.has_kinematics ? "The same error, projected to the joints" : "Error per joint";
  for (const bool prismatic : {false, true}) {
    std::vector<std::size_t> joints;
    for (std::size_t j = 0; j < verdict.joints.size(); ++j)
      if (verdict.prismatic[j] == prismatic) joints.push_back(j);
    if (joints.empty()) continue;
    Axis axis;
    axis.label = "measured minus simulated";
    axis.unit = unitOfJoint(verdict, joints.front()).name;
    for (const Side& side : sidesOf(verdict)) {
      std::vector<std::vector<double>> rows;
      std::vector<std::string> names;
      for (const std::size_t j : joints) {
        names.push_back(verdict.joints[j]);
        rows.push_back(rowOf(side.residual.joints, static_cast<Eigen::Index>(j),
                             unitOfJoint(verdict, j).scale));
      }
      figure.panels.push_back(stripsPanel(names, rows, side, axis,
                                          prismatic ? "Joints that slide" : "Joints that turn"));
    }
    shareLimits(pointers(figure.panels, figure.panels.size() - 2, 2), false, true);
  }
  figure.how_to_read =
      verdict.has_kinematics
          ? "What each joint would have to be wrong by to make the same error of the tool (damped "
            "inverse of the Jacobian). An error of registration or tool frame shows up here as "
            "errors of several joints. Strips as in the figure above; same limits left and right."
          : "Line: 5 % to 95 % of the samples; box: the middle half; bar across: the median. Same "
            "limits left and right.";
  figure.good = "after, no joint stands out.";
  return figure;
}

Figure causesFigure(const Verdict& verdict) {
  Figure figure;
  figure.title = "What each cause explains";
  figure.columns = 1;
  Panel panel;
  panel.width = 460.0;
  panel.height = 70.0 + 24.0 * static_cast<double>(verdict.causes.size());
  panel.x = Axis("share of the held-out loss that goes with it", "%");
  panel.x.from_zero = true;  // and an interval that crosses it is seen to
  Bars bars;
  bars.horizontal = true;
  bars.decimals = 1;
  bars.label = "share, with its 95 % interval over motions";
  bars.ink = Ink::kSky;
  for (std::size_t i = 0; i < verdict.causes.size(); ++i) {
    panel.y.categories.push_back(verdict.labels[i]);
    bars.position.push_back(static_cast<double>(i));
    bars.value.push_back(kPercent * verdict.causes[i].share);
    bars.lower.push_back(kPercent * verdict.causes[i].lower);
    bars.upper.push_back(kPercent * verdict.causes[i].upper);
  }
  panel.layers.push_back(bars);
  figure.panels.push_back(panel);
  figure.how_to_read =
      "Each cause alone was dropped and all others were fitted again; the bar is how much of the "
      "loss on motions held out goes when it is put back. The loss is squared, and counts position "
      "and orientation alike. Shares do not add up to 100 %.";
  figure.good = "few causes with long bars, whose intervals stay clear of zero.";
  return figure;
}

Figure workspaceFigure(const Verdict& verdict) {
  Figure figure;
  figure.title = "Where in the workspace the error is";
  const Eigen::MatrixXd& p = verdict.figures.position;
  const std::pair<int, int> views[] = {{0, 1}, {0, 2}};
  const char* const names[] = {"x", "y", "z"};
  for (const auto& [a, b] : views) {
    for (const Side& side : sidesOf(verdict)) {
      Panel panel;
      panel.title = std::string("seen along ") + names[3 - a - b] + ", " + side.title;
      panel.x = Axis(names[a], "mm");
      panel.y = Axis(names[b], "mm");
      const std::vector<double> u = rowOf(p, a, kMillimetre), v = rowOf(p, b, kMillimetre);
      Axis along, up;
      limitTo(along, u, kShown);
      limitTo(up, v, kShown);
      if (!std::isfinite(along.lower) || !std::isfinite(up.lower)) continue;
      HeatMap map;
      map.label = "median error [mm]";
      for (int i = 0; i <= kCells; ++i) {
        map.x_edges.push_back(along.lower + (along.upper - along.lower) * i / kCells);
        map.y_edges.push_back(up.lower + (up.upper - up.lower) * i / kCells);
      }
      std::vector<std::vector<double>> cells(kCells * kCells);
      const std::vector<double> error = lengths(side.residual.tool, 0, kMillimetre);
      for (std::size_t i = 0; i < error.size(); ++i) {
        const double c = std::floor((u[i] - along.lower) / (along.upper - along.lower) * kCells);
        const double r = std::floor((v[i] - up.lower) / (up.upper - up.lower) * kCells);
        if (c >= 0.0 && c < kCells && r >= 0.0 && r < kCells)
          cells[static_cast<std::size_t>(r * kCells + c)].push_back(error[i]);
      }
      map.values.resize(kCells, kCells);
      const std::size_t least = 3;
      for (int r = 0; r < kCells; ++r)
        for (int c = 0; c < kCells; ++c) {
          const auto& cell = cells[static_cast<std::size_t>(r * kCells + c)];
          map.values(r, c) = cell.size() < least ? kUnset : quantilesOf(cell).p50;
        }
      panel.layers.push_back(map);
      figure.panels.push_back(panel);
    }
  }
  std::vector<Panel*> all = pointers(figure.panels, 0, figure.panels.size());
  shareColours(all);
  figure.how_to_read =
      "Median length of the position error of the samples in each cell, by the measured position "
      "in "
      "the base frame; the number stands in the cell. Cells with fewer than three samples are "
      "empty: nothing was recorded there. All four have the same colours.";
  figure.good = "after, all cells are light and alike.";
  return figure;
}

Figure foldsFigure(const Verdict& verdict) {
  Figure figure;
  figure.title = "Fold by fold";
  for (const bool position : {true, false}) {
    Panel panel;
    panel.title = position ? "Position" : "Orientation";
    panel.height = 240.0;
    panel.x.label = "fold";
    panel.y = Axis(position ? "median error" : "median angle", position ? "mm" : "deg");
    panel.y.from_zero = true;
    const auto add = [&](const DiagnosisErrors& errors, const char* label, Ink ink, Stroke stroke,
                         Marker marker) {
      const std::vector<double>& values =
          position ? errors.fold_position_median : errors.fold_orientation_median;
      Line line;
      line.label = label;
      line.ink = ink;
      line.stroke = stroke;
      line.markers = true;
      line.marker = marker;
      for (std::size_t k = 0; k < values.size(); ++k) {
        line.x.push_back(static_cast<double>(k));
        line.y.push_back((position ? kMillimetre : kDegree) * values[k]);
      }
      panel.layers.push_back(line);
    };
    for (std::size_t k = 0; k < verdict.before.fold_position_median.size(); ++k)
      panel.x.categories.push_back(std::to_string(k));
    add(verdict.before, kBefore, kInkBefore, Stroke::kDashed, Marker::kCircle);
    if (verdict.aligned)
      add(verdict.after_alignment, "registration and tool frame alone", Ink::kGrey, Stroke::kDotted,
          Marker::kTriangle);
    add(verdict.after, kAfter, kInkAfter, Stroke::kSolid, Marker::kSquare);
    figure.panels.push_back(panel);
  }
  figure.how_to_read =
      "Motion i is in fold i modulo the number of folds; each fold was predicted with parameters "
      "fitted without it, and with causes that were chosen with all motions in view.";
  figure.good = "the solid line is low and level: the gain does not hang on a few motions.";
  return figure;
}

}  // namespace raven_correction
