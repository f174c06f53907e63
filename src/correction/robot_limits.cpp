// SPDX-License-Identifier: BSD-3-Clause
#include "raven_correction/correction/robot_limits.h"

#include <algorithm>
#include <cmath>

#include "raven_correction/error.h"

namespace raven_correction {
namespace {

/// Other branches differ in some joint by about pi, other turns by 2 pi [rad].
constexpr double kSameBranch = 0.5 * 3.14159265358979323846;

Eigen::Vector3d clamp(const Eigen::AlignedBox3d& room, const Eigen::Vector3d& p) noexcept {
  return p.cwiseMax(room.min()).cwiseMin(room.max());
}

/// The point of `room` within `radius` of `centre` that is nearest to p, where p is further away
/// even inside `room`. Minimising |x - p|^2 + w |x - centre|^2 over the box gives x = clamp(centre
/// + (p - centre) / (1 + w)); the distance from the centre falls as w grows.
Eigen::Vector3d nearest(const Eigen::AlignedBox3d& room, const Eigen::Vector3d& centre,
                        double radius, const Eigen::Vector3d& p) noexcept {
  const Eigen::Vector3d way = p - centre;
  const Eigen::Vector3d on_ball = centre + way * (radius / way.norm());
  if (room.contains(on_ball)) return on_ball;
  double low = 0.0, high = 1.0;  // 1 / (1 + w)
  for (int i = 0; i < 50; ++i) {
    const double middle = 0.5 * (low + high);
    const bool inside = (clamp(room, centre + middle * way) - centre).norm() <= radius;
    (inside ? low : high) = middle;
  }
  return clamp(room, centre + low * way);
}

}  // namespace

NearTool keepNear(const RobotLimits& limits, const Pose* tool, const Eigen::AlignedBox3d& room,
                  const Pose& desired, const Pose& corrected) noexcept {
  NearTool near;
  near.command = corrected;
  near.command.p = clamp(room, corrected.p);
  near.shortened_room = near.command.p != corrected.p;
  if (tool == nullptr) return near;
  if (limits.max_step > 0.0) {
    const double own = (desired.p - tool->p).norm();
    const double radius = std::max(limits.max_step, own);
    near.desired_beyond |= own > limits.max_step;
    near.shortened_position = (near.command.p - tool->p).norm() > radius;
    if (near.shortened_position) near.command.p = nearest(room, tool->p, radius, corrected.p);
  }
  if (limits.max_turn > 0.0) {
    const double own = rotationAngle(tool->q, desired.q);
    const double radius = std::max(limits.max_turn, own);
    const Eigen::Vector3d turn = logRotation(tool->q.conjugate() * corrected.q);
    near.desired_beyond |= own > limits.max_turn;
    near.shortened_orientation = turn.norm() > radius;
    if (near.shortened_orientation)
      near.command.q = (tool->q * expRotation(turn * (radius / turn.norm()))).normalized();
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
  IkOptions options;
  options.search_elsewhere = false;  // bounds the time
  solver_ = std::make_unique<const InverseKinematics>(*limits.chain, options);
  options.inside_first = false;
  nearest_ = std::make_unique<const InverseKinematics>(*limits.chain, options);
  for (const Joint& joint : limits.chain->joints())
    revolute_.push_back(joint.type == JointType::kRevolute);
  joints_ = followed_ = limits.chain->home();
}

void RobotReach::follow(const Pose& desired) noexcept {
  if (solver_ == nullptr) return;
  desired_ = desired;
  followed_ = solver_->solve(desired, joints_).joints;
}

bool RobotReach::reaches(const Pose& pose) const noexcept {
  if (solver_ == nullptr) return true;
  const IkResult result = nearest_->solve(pose, followed_);
  // Near a singularity joints exist, and controllers take them.
  if (result.status != IkStatus::kOk && result.status != IkStatus::kSingular) return false;
  for (std::size_t i = 0; i < revolute_.size(); ++i) {
    const auto joint = static_cast<Eigen::Index>(i);
    if (revolute_[i] && !(std::abs(result.joints(joint) - followed_(joint)) <= kSameBranch))
      return false;
  }
  return true;
}

double RobotReach::reachableShare(const Eigen::Vector3d& translation,
                                  const Eigen::Vector3d& rotation) const noexcept {
  const auto reached = [&](double share) {
    return reaches({desired_.p + share * translation,
                    (desired_.q * expRotation(share * rotation)).normalized()});
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
