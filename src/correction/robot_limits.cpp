// SPDX-License-Identifier: BSD-3-Clause
#include "raven_correction/correction/robot_limits.h"

#include <algorithm>
#include <cmath>

#include "raven_correction/error.h"

namespace raven_correction {

NearTool keepNear(const RobotLimits& limits, const Pose& tool, const Pose& desired,
                  const Pose& corrected) noexcept {
  NearTool near;
  near.command = corrected;
  if (limits.max_step > 0.0) {
    const double own = (desired.p - tool.p).norm();
    const double radius = std::max(limits.max_step, own);
    const Eigen::Vector3d step = corrected.p - tool.p;
    near.desired_beyond |= own > limits.max_step;
    near.shortened_position = step.norm() > radius;
    if (near.shortened_position) near.command.p = tool.p + step * (radius / step.norm());
  }
  if (limits.max_turn > 0.0) {
    const double own = rotationAngle(tool.q, desired.q);
    const double radius = std::max(limits.max_turn, own);
    const Eigen::Vector3d turn = logRotation(tool.q.conjugate() * corrected.q);
    near.desired_beyond |= own > limits.max_turn;
    near.shortened_orientation = turn.norm() > radius;
    if (near.shortened_orientation)
      near.command.q = (tool.q * expRotation(turn * (radius / turn.norm()))).normalized();
  }
  return near;
}

RobotReach::RobotReach(const RobotLimits& limits) {
  const struct {
    const char* name;
    double value;
  } lengths[] = {{"max_step", limits.max_step}, {"max_turn", limits.max_turn}};
  for (const auto& length : lengths)
    if (!(length.value >= 0.0) || !std::isfinite(length.value))
      throw InvalidInput(
          format("robot limits: %s = %g, must be >= 0 and finite", length.name, length.value));
  if (limits.chain == nullptr) return;
  solver_ = std::make_unique<const InverseKinematics>(*limits.chain);
  joints_ = limits.chain->home();
}

bool RobotReach::reaches(const Pose& pose) noexcept {
  if (solver_ == nullptr) return true;
  const IkResult result = solver_->solve(pose, joints_);
  // Near a singularity joints exist, and controllers take them.
  if (result.status != IkStatus::kOk && result.status != IkStatus::kSingular) return false;
  joints_ = result.joints;
  return true;
}

double RobotReach::reachableShare(const Pose& desired, const Eigen::Vector3d& translation,
                                  const Eigen::Vector3d& rotation) noexcept {
  const auto reached = [&](double share) {
    return reaches({desired.p + share * translation,
                    (desired.q * expRotation(share * rotation)).normalized()});
  };
  if (reached(1.0)) return 1.0;
  if (!reached(0.0)) return 0.0;
  double low = 0.0, high = 1.0;
  for (int i = 0; i < 7; ++i) {
    const double middle = 0.5 * (low + high);
    (reached(middle) ? low : high) = middle;
  }
  return low;
}

}  // namespace raven_correction
