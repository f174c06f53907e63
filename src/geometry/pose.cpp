// SPDX-License-Identifier: BSD-3-Clause
#include "raven_correction/geometry/pose.h"

#include <cmath>

namespace raven_correction {

bool isFinite(const Pose& pose) noexcept {
  return pose.p.allFinite() && pose.q.coeffs().allFinite();
}

bool hasUnitQuaternion(const Pose& pose) noexcept {
  return std::abs(pose.q.norm() - 1.0) <= kUnitTolerance;  // false for NaN
}

bool isIdentity(const Pose& pose) noexcept {
  return pose.p.isZero(0.0) && pose.q.vec().isZero(0.0) && std::abs(pose.q.w()) == 1.0;
}

Pose interpolate(const Pose& a, const Pose& b, double s) noexcept {
  const Eigen::Vector3d turn = logRotation(a.q.conjugate() * b.q);
  return {a.p + s * (b.p - a.p), (a.q * expRotation(s * turn)).normalized()};
}

}  // namespace raven_correction
