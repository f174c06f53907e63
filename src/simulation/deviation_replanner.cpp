// SPDX-License-Identifier: BSD-3-Clause
#include "raven_correction/simulation/deviation_replanner.h"

#include <algorithm>
#include <array>
#include <vector>

#include "raven_correction/error.h"
#include "raven_correction/geometry/statistics.h"

namespace raven_correction {
namespace {

constexpr double kLongestGap = 0.2;  // between two commands that are interpolated [s]

}  // namespace

DeviationReplanner::DeviationReplanner(const ReplanConfig& config) : config_(config) {
  if (!(config.delay >= 0.0 && config.blend > 0.0 && config.samples > 0 && config.jump > 0.0 &&
        config.jump_angle > 0.0 && config.jumps_believed > 0))
    throw InvalidInput(
        format("replanning: delay = %g s (>= 0), blend = %g s, samples = %zu, jump = %g m, "
               "jump_angle = %g rad, jumps_believed = %u (all > 0)",
               config.delay, config.blend, config.samples, config.jump, config.jump_angle,
               config.jumps_believed));
}

DeviationReplanner::Deviation DeviationReplanner::at(double time) const noexcept {
  const double s = std::clamp((time - since_) / config_.blend, 0.0, 1.0);
  return {from_.d + s * (to_.d - from_.d), from_.r + s * (to_.r - from_.r)};
}

Pose DeviationReplanner::command(const Pose& desired, double time) const noexcept {
  const Deviation deviation = at(time);
  return {desired.p - deviation.d, (desired.q * expRotation(-deviation.r)).normalized()};
}

bool DeviationReplanner::measure(const PoseStream& commands, const PoseStream& observed,
                                 double time) {
  std::array<std::vector<double>, 6> components;
  for (const StampedPose& sample : observed) {
    const auto command = poseAt(commands, sample.stamp - config_.delay, kLongestGap);
    if (!command) continue;
    const Eigen::Vector3d d = sample.pose.p - command->p;
    const Eigen::Vector3d r = logRotation(command->q.conjugate() * sample.pose.q);
    for (int i = 0; i < 3; ++i) {
      components[static_cast<std::size_t>(i)].push_back(d(i));
      components[static_cast<std::size_t>(i) + 3].push_back(r(i));
    }
  }
  if (components[0].size() < config_.samples) return false;
  Deviation measured;
  for (int i = 0; i < 3; ++i) {
    measured.d(i) = median(components[static_cast<std::size_t>(i)]);
    measured.r(i) = median(components[static_cast<std::size_t>(i) + 3]);
  }
  const bool jumped = (measured.d - to_.d).norm() > config_.jump ||
                      (measured.r - to_.r).norm() > config_.jump_angle;
  const bool expected = measurements_ > 0 || config_.corrected;
  if (expected && jumped && ++jumps_ < config_.jumps_believed) return false;
  jumps_ = 0;
  from_ = at(time);
  to_ = measured;
  since_ = time;
  ++measurements_;
  return true;
}

void DeviationReplanner::forget(double time) noexcept {
  from_ = at(time);
  to_ = {};
  since_ = time;
  measurements_ = jumps_ = 0;
}

}  // namespace raven_correction
