// SPDX-License-Identifier: BSD-3-Clause
#include "raven_correction/correction/physics.h"

#include <algorithm>
#include <cctype>

#include "raven_correction/error.h"
#include "raven_correction/geometry/statistics.h"

namespace raven_correction {
namespace {

std::string lowerCase(std::string text) {
  for (char& c : text) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return text;
}

/// Data sets name their arm as the simulator does, "raven2_left", or in words: "Raven II, left
/// arm".
bool isAnotherArm(const std::string& arm, const std::string& robot) {
  const std::string a = lowerCase(arm), b = lowerCase(robot);
  if (a.empty() || a == b) return false;
  const bool is_a_name = a.find_first_not_of("abcdefghijklmnopqrstuvwxyz0123456789_") == a.npos &&
                         a.find('_') != a.npos;
  const auto says = [](const std::string& text, const char* side) {
    return text.find(side) != text.npos;
  };
  return is_a_name || (says(a, "left") && says(b, "right")) ||
         (says(a, "right") && says(b, "left"));
}

double medianCommandPeriod(const Dataset& dataset) {
  std::vector<double> periods;
  for (const Trajectory& trajectory : dataset.trajectories)
    if (const double period = medianPeriod(trajectory.commands); period > 0.0)
      periods.push_back(period);
  return periods.empty() ? 0.0 : median(std::move(periods));
}

/// From the first command of the last session to its last.
double durationOf(const Dataset& dataset) {
  double first = 0.0, last = 0.0;
  bool any = false;
  const std::vector<std::size_t> sessions = sessionStarts(dataset);
  for (std::size_t i = sessions.empty() ? 0 : sessions.back(); i < dataset.trajectories.size();
       ++i) {
    const Trajectory& trajectory = dataset.trajectories[i];
    if (trajectory.commands.empty()) continue;
    const double begin = trajectory.commands.front().stamp, end = trajectory.commands.back().stamp;
    first = any ? std::min(first, begin) : begin;
    last = any ? std::max(last, end) : end;
    any = true;
  }
  return std::max(0.0, last - first);
}

}  // namespace

Correction::Physics physicsOf(const SimulationConfig& simulation, const Dataset& dataset,
                              double delay) {
  const std::string& robot = simulation.robot.name();
  if (dataset.frame != simulation.robot.frame())
    throw InvalidInput(
        format("%s: its poses are in frame \"%s\", the robot %s of simulation %s is described in "
               "\"%s\"; use the simulation of this robot and frame",
               dataset.source.c_str(), dataset.frame.c_str(), robot.c_str(),
               simulation.name.c_str(), simulation.robot.frame().c_str()));
  if (isAnotherArm(dataset.arm, robot))
    throw InvalidInput(format(
        "%s: recorded with the arm \"%s\", but simulation %s is of the robot %s; use the "
        "simulation of this arm",
        dataset.source.c_str(), dataset.arm.c_str(), simulation.name.c_str(), robot.c_str()));
  Correction::Physics physics;
  physics.texts = simulationTexts(simulation);
  physics.timing.delay = delay;
  physics.timing.hold = 0.5 * medianCommandPeriod(dataset);
  physics.timing.age = durationOf(dataset);
  return physics;
}

std::optional<InverseArm> inverseArmOf(const Correction::Physics& physics) {
  if (physics.empty()) return std::nullopt;
  return InverseArm(simulationFromTexts(physics.texts, "simulation of the model"), physics.timing);
}

ToolPath pathOf(const Motion& motion, const MotionOptions& options) noexcept {
  static_assert(ToolPath::kMost == 1 + kMaxTwists, "a corner for each twist, and now");
  ToolPath path;
  path.corners[0] = {0.0, motion.pose};
  path.count = 1;
  Eigen::Vector3d moved = Eigen::Vector3d::Zero(), turned = moved;  // back from now
  for (std::size_t k = 0; k < twistCount(options); ++k) {
    const double ago =
        options.velocity == VelocityKind::kPast ? options.intervals[k] : options.window;
    const double time = ago - path.corners[k].ago;
    moved -= time * motion.twists[k].v;
    turned -= time * motion.twists[k].w;
    path.corners[k + 1] = {
        ago, {motion.pose.p + moved, (expRotation(turned) * motion.pose.q).normalized()}};
    ++path.count;
  }
  return path;
}

}  // namespace raven_correction
