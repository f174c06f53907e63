// SPDX-License-Identifier: BSD-3-Clause
// Random poses and rotations for property tests; every test seeds its own engine.
#pragma once

#include <random>

#include "raven_correction/geometry/pose.h"

namespace raven_correction {

inline Eigen::Vector3d randomVector(std::mt19937_64& random, double deviation) {
  std::normal_distribution<double> normal(0.0, deviation);
  return {normal(random), normal(random), normal(random)};
}

/// Uniform over all orientations.
inline Eigen::Quaterniond randomRotation(std::mt19937_64& random) {
  std::normal_distribution<double> normal;
  Eigen::Quaterniond q(normal(random), normal(random), normal(random), normal(random));
  return q.normalized();
}

/// Any orientation, position of the given deviation [m].
inline Pose randomPose(std::mt19937_64& random, double deviation = 0.05) {
  return {randomVector(random, deviation), randomRotation(random)};
}

}  // namespace raven_correction
