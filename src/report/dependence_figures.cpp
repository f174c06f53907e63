// SPDX-License-Identifier: BSD-3-Clause
// What the residual of a diagnosis depends on, as figures.
#include <algorithm>
#include <cmath>

#include "diagnosis_figures.h"
#include "diagnosis_panels.h"
#include "diagnosis_words.h"
#include "raven_correction/error.h"
#include "raven_correction/report/figure_limits.h"
#include "report_json.h"

namespace raven_correction {
namespace {

constexpr std::size_t kDots = 450;  // in one panel: more would only be ink
constexpr int kTrendBins = 14;

/// Evenly spread picks of points for a scatter.
Points thinned(const std::vector<double>& x, const std::vector<double>& y, Ink ink) {
  Points points;
  points.ink = ink;
  points.opacity = 0.45;
  const std::size_t stride = std::max<std::size_t>(1, x.size() / kDots);
  for (std::size_t i = 0; i < std::min(x.size(), y.size()); i += stride) {
    points.x.push_back(x[i]);
    points.y.push_back(y[i]);
  }
  return points;
}

const char* variableLabel(JointVariable variable) {
  switch (variable) {
    case JointVariable::kPosition:
      return "position of the joint";
    case JointVariable::kSpeed:
      return "speed of the joint";
    case JointVariable::kLoad:
      return "load of gravity on the joint";
  }
  return "";
}

/// Every row with its median taken off.
Eigen::MatrixXd withoutMedian(Eigen::MatrixXd values) {
  for (Eigen::Index row = 0; row < values.rows(); ++row)
    values.row(row).array() -= quantilesOf(rowOf(values, row, 1.0)).p50;
  return values;
}

/// Whether gravity on the joint changes over the recording.
bool isLoaded(const Verdict& verdict, std::size_t joint) {
  const Eigen::MatrixXd& load = verdict.figures.load;
  if (load.size() == 0) return false;
  const auto row = load.row(static_cast<Eigen::Index>(joint));
  return row.maxCoeff() - row.minCoeff() > 1e-3;  // Nm or N
}

/// Error of one joint against one variable of it.
Panel jointPanel(const Verdict& verdict, JointVariable variable, std::size_t joint,
                 const Side& side) {
  const JointUnit unit = unitOfJoint(verdict, joint);
  const auto r = static_cast<Eigen::Index>(joint);
  const ResidualSamples& samples = verdict.figures;
  const bool load = variable == JointVariable::kLoad;
  Panel panel;
  panel.title = verdict.joints[joint] + ", " + side.title;
  panel.width = 300.0;
  panel.height = 215.0;
  panel.x.label = variableLabel(variable);
  panel.x.unit = load                                ? (verdict.prismatic[joint] ? "N" : "Nm")
                 : variable == JointVariable::kSpeed ? unit.name + std::string("/s")
                                                     : unit.name;
  panel.y.label = "error";
  panel.y.unit = unit.name;
  const std::vector<double> x = rowOf(load                                ? samples.load
                                      : variable == JointVariable::kSpeed ? samples.speed
                                                                          : samples.joints,
                                      r, load ? 1.0 : unit.scale);
  const std::vector<double> y = rowOf(side.residual.joints, r, unit.scale);
  limitTo(panel.x, x, kShown);
  panel.layers.push_back(thinned(x, y, Ink::kGrey));
  if (variable == JointVariable::kSpeed) {
    Trend trend = trendOf(x, y, kTrendBins);
    trend.median.label = "median";
    trend.quartiles.label = "middle half";
    trend.median.ink = trend.quartiles.ink = side.ink;
    panel.layers.push_back(trend.quartiles);
    panel.layers.push_back(trend.median);
    return panel;
  }
  const std::vector<double> speed = rowOf(samples.speed, r, 1.0);
  for (const bool up : {true, false}) {
    std::vector<double> a, b;
    for (std::size_t i = 0; i < x.size(); ++i) {
      if (!(up ? speed[i] > 0.0 : speed[i] < 0.0)) continue;
      a.push_back(x[i]);
      b.push_back(y[i]);
    }
    Trend trend = trendOf(a, b, kTrendBins);
    trend.median.label = up ? "median while the joint moves up" : "median while it moves down";
    trend.median.ink = up ? Ink::kGreen : Ink::kPurple;
    trend.median.stroke = up ? Stroke::kSolid : Stroke::kDashed;
    trend.median.markers = true;
    trend.median.marker = up ? Marker::kTriangle : Marker::kSquare;
    panel.layers.push_back(trend.median);
  }
  return panel;
}

}  // namespace

Figure dependenceFigure(const Verdict& verdict) {
  Figure figure;
  figure.title = "What the error depends on, whatever its cause";
  for (const bool before : {true, false}) {
    const DependenceResult& result = before ? verdict.shown : verdict.left;
    Panel panel;
    panel.title = before ? "before" : "after";
    panel.height = 250.0;
    panel.x = Axis("share that can be predicted", "%");
    Bars bars;
    bars.horizontal = true;
    bars.decimals = 0;
    bars.hollow = before;
    bars.ink = before ? kInkBefore : kInkAfter;
    bars.label = before ? kBefore : kAfter;
    std::vector<Dependence> groups = orderedGroups(result);
    groups.push_back(result.anything);
    for (std::size_t i = 0; i < groups.size(); ++i) {
      panel.y.categories.push_back(groups[i].on == "anything" ? "all together" : groups[i].on);
      bars.position.push_back(static_cast<double>(i));
      bars.value.push_back(kPercent * groups[i].share);
      bars.lower.push_back(kPercent * groups[i].lower);
      bars.upper.push_back(kPercent * groups[i].upper);
    }
    panel.layers.push_back(bars);
    figure.panels.push_back(panel);
  }
  shareLimits(pointers(figure.panels, 0, 2), true, false);
  figure.how_to_read =
      "Share of the squared error about its mean that a regression on functions of one kind of "
      "quantity predicts on motions it has not learnt from, with 95 % intervals over motions. "
      "Direction includes history (which side a play rests on). Kinds overlap: shares do not add "
      "up. Below zero: a prediction that is worse than the mean.";
  figure.good =
      "before, a few long bars, which say where to look; after, every interval holds zero.";
  return figure;
}

Figure delayFigure(const Verdict& verdict) {
  Figure figure;
  figure.title = "Delay: error along the motion against speed";
  const ResidualSamples& samples = verdict.figures;
  const bool tool = verdict.has_kinematics;
  const std::size_t count = tool ? 1 : verdict.joints.size();
  for (std::size_t j = 0; j < count; ++j) {
    const JointUnit unit = tool ? JointUnit{kMillimetre, "mm"} : unitOfJoint(verdict, j);
    const auto r = static_cast<Eigen::Index>(j);
    for (const Side& side : sidesOf(verdict)) {
      std::vector<double> x, y;
      const Eigen::MatrixXd error = tool ? withoutMedian(side.residual.tool.topRows(3))
                                         : withoutMedian(side.residual.joints.row(r));
      const Eigen::MatrixXd velocity = tool ? samples.velocity : samples.speed.row(r);
      for (Eigen::Index i = 0; i < error.cols(); ++i) {
        const double speed = velocity.col(i).norm();
        if (!(speed > 0.0)) continue;
        x.push_back(unit.scale * speed);
        y.push_back(unit.scale * error.col(i).dot(velocity.col(i)) / speed);
      }
      Panel panel;
      panel.title = (tool ? std::string("tool") : verdict.joints[j]) + ", " + side.title;
      panel.x = Axis("speed", unit.name + std::string("/s"));
      panel.x.from_zero = true;
      panel.y = Axis("error along the motion", unit.name);
      limitTo(panel.x, x, kShown);
      panel.x.lower = 0.0;
      limitTo(panel.y, y, kShown);
      panel.layers.push_back(thinned(x, y, Ink::kGrey));
      Trend trend = trendOf(x, y, kTrendBins);
      trend.median.label = "median";
      trend.quartiles.label = "middle half";
      trend.median.ink = trend.quartiles.ink = side.ink;
      panel.layers.push_back(trend.quartiles);
      panel.layers.push_back(trend.median);
      const double delay = (side.before ? verdict.shown : verdict.left).delay;
      if (std::isfinite(panel.x.upper) && tool) {
        Line line;
        line.label = "slope of the best single delay";
        line.stroke = Stroke::kDashed;
        line.x = {0.0, panel.x.upper};
        line.y = {0.0, -delay * panel.x.upper};
        panel.layers.push_back(line);
      }
      figure.panels.push_back(panel);
    }
    shareLimits(pointers(figure.panels, figure.panels.size() - 2, 2), true, true);
  }
  figure.how_to_read = format(
      "The median error of the recording is taken off first. Below zero the %s trails behind the "
      "simulation. A delay makes a straight line through zero "
      "whose slope is minus the delay; the best single delay is %.0f ms before and %.0f ms after. "
      "A lag bends it, friction and play shift it down at any speed.",
      tool ? "tool" : "joint", 1e3 * verdict.shown.delay, 1e3 * verdict.left.delay);
  figure.good = "after, the median stays at zero at every speed.";
  return figure;
}

Figure jointFigure(const Verdict& verdict, JointVariable variable) {
  Figure figure;
  figure.columns = 4;
  for (std::size_t j = 0; j < verdict.joints.size(); ++j) {
    if (variable == JointVariable::kLoad && !isLoaded(verdict, j)) continue;
    const std::size_t first = figure.panels.size();
    std::vector<double> both;
    for (const Side& side : sidesOf(verdict)) {
      figure.panels.push_back(jointPanel(verdict, variable, j, side));
      const std::vector<double> values =
          rowOf(side.residual.joints, static_cast<Eigen::Index>(j), unitOfJoint(verdict, j).scale);
      both.insert(both.end(), values.begin(), values.end());
    }
    for (std::size_t k = first; k < figure.panels.size(); ++k)
      limitTo(figure.panels[k].y, both, kShown);
    shareLimits(pointers(figure.panels, first, 2), true, true);
  }
  switch (variable) {
    case JointVariable::kPosition:
      figure.title = "Position and direction of motion: error of each joint";
      figure.how_to_read =
          "Up and down are two lines. A slope is a wrong ratio or a coupling, a wave an eccentric "
          "pulley, a constant an offset; a distance between the two lines is play or friction (the "
          "error then depends on where the joint came from), or a delay.";
      break;
    case JointVariable::kSpeed:
      figure.title = "Speed: error of each joint";
      figure.how_to_read =
          "A falling straight line is a delay or a lag, a step at zero is play or friction, a line "
          "that falls only beyond some speed is a limit of speed.";
      break;
    case JointVariable::kLoad:
      figure.title = "Load: error of each joint";
      figure.how_to_read =
          "Gravity on the joint, from the masses in the robot's file; joints without load are left "
          "out. A rising line is a cable "
          "that "
          "gives way. Load changes with posture, so a wrong ratio can look alike.";
      break;
  }
  figure.how_to_read +=
      " Before and after of a joint have the same limits, with room for 98 % of the samples.";
  figure.good = "after, the lines lie on zero and on one another.";
  return figure;
}

Figure timeFigure(const Verdict& verdict) {
  Figure figure;
  figure.title = "Time: error over the session";
  const ResidualSamples& samples = verdict.figures;
  const bool tool = verdict.has_kinematics;
  const bool minutes = samples.size() > 0 && samples.stamp.back() > 600.0;
  std::vector<double> time = samples.stamp;
  if (minutes)
    for (double& t : time) t /= 60.0;
  struct Part {
    std::string name;
    JointUnit unit;
    Eigen::Index row;
  };
  std::vector<Part> parts;
  if (tool) {
    const char* const names[] = {"x", "y", "z", "about x", "about y", "about z"};
    for (int k = 0; k < 6; ++k)
      parts.push_back({names[k], {unitOf(k), unitName(k)}, static_cast<Eigen::Index>(k)});
  } else {
    for (std::size_t j = 0; j < verdict.joints.size(); ++j)
      parts.push_back({verdict.joints[j], unitOfJoint(verdict, j), static_cast<Eigen::Index>(j)});
  }
  figure.columns = 4;
  for (const Part& part : parts) {
    std::vector<double> both;
    const std::size_t first = figure.panels.size();
    for (const Side& side : sidesOf(verdict)) {
      const std::vector<double> y =
          rowOf(tool ? side.residual.tool : side.residual.joints, part.row, part.unit.scale);
      both.insert(both.end(), y.begin(), y.end());
      Panel panel;
      panel.title = part.name + ", " + side.title;
      panel.width = 300.0;
      panel.height = 200.0;
      panel.x = Axis("time", minutes ? "min" : "s");
      panel.y = Axis("error", part.unit.name);
      panel.layers.push_back(thinned(time, y, Ink::kGrey));
      Trend trend = trendOf(time, y, 2 * kTrendBins);
      trend.median.label = "median";
      trend.quartiles.label = "middle half";
      trend.median.ink = trend.quartiles.ink = side.ink;
      panel.layers.push_back(trend.quartiles);
      panel.layers.push_back(trend.median);
      figure.panels.push_back(panel);
    }
    for (std::size_t k = first; k < figure.panels.size(); ++k)
      limitTo(figure.panels[k].y, both, kShown);
    shareLimits(pointers(figure.panels, first, 2), true, true);
  }
  figure.how_to_read =
      "A step is a base or camera that was bumped, a slow curve is creep or warming up. Before and "
      "after have the same limits, with room for 98 % of the samples.";
  figure.good = "after, the median stays at zero from beginning to end.";
  return figure;
}

}  // namespace raven_correction
