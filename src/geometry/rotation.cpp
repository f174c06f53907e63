// SPDX-License-Identifier: BSD-3-Clause
#include "raven_correction/geometry/rotation.h"

#include <Eigen/SVD>
#include <cmath>

#include "raven_correction/error.h"

namespace raven_correction {

Eigen::Quaterniond expRotation(const Eigen::Vector3d& r) noexcept {
  const double angle_squared = r.squaredNorm();
  // sin(a/2)/a = 1/2 - a^2/48 + a^4/3840 - ...: below 1e-3 rad the next term is under 1e-22.
  double scale;
  if (angle_squared < 1e-6) {
    scale = 0.5 - angle_squared / 48.0 + angle_squared * angle_squared / 3840.0;
  } else {
    const double angle = std::sqrt(angle_squared);
    scale = std::sin(0.5 * angle) / angle;
  }
  Eigen::Quaterniond q;
  q.w() = std::cos(0.5 * std::sqrt(angle_squared));
  q.vec() = scale * r;
  return q;
}

Eigen::Vector3d logRotation(const Eigen::Quaterniond& q) noexcept {
  // With w >= 0 the vector part is sin(a/2) n, a in [0, pi]; atan2 is accurate at both ends.
  const double sign = q.w() < 0.0 ? -1.0 : 1.0;
  const Eigen::Vector3d v = sign * q.vec();
  const double w = sign * q.w();
  const double s = v.norm();
  if (s < 1e-9) return (2.0 / w) * v;  // a/sin(a/2) = 2 (1 + a^2/24): exact to rounding here
  return (2.0 * std::atan2(s, w) / s) * v;
}

double rotationAngle(const Eigen::Quaterniond& a, const Eigen::Quaterniond& b) noexcept {
  const Eigen::Quaterniond d = a.conjugate() * b;
  return 2.0 * std::atan2(d.vec().norm(), std::abs(d.w()));
}

Eigen::Vector3d zyxAngles(const Eigen::Matrix3d& R) noexcept {
  const double cos_pitch = std::hypot(R(0, 0), R(1, 0));
  const double pitch = std::atan2(-R(2, 0), cos_pitch);
  if (cos_pitch < 1e-12) return {std::atan2(-R(0, 1), R(1, 1)), pitch, 0.0};
  return {std::atan2(R(1, 0), R(0, 0)), pitch, std::atan2(R(2, 1), R(2, 2))};
}

Eigen::Matrix3d nearestRotation(const Eigen::Matrix3d& M) {
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(M, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const Eigen::Matrix3d& U = svd.matrixU();
  const Eigen::Matrix3d& V = svd.matrixV();
  const double handedness = (U * V.transpose()).determinant() < 0.0 ? -1.0 : 1.0;
  return U * Eigen::Vector3d(1.0, 1.0, handedness).asDiagonal() * V.transpose();
}

Eigen::Quaterniond meanRotation(const std::vector<Eigen::Quaterniond>& rotations) {
  if (rotations.empty()) throw InvalidInput("the mean of no rotations is not defined");
  Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
  for (const Eigen::Quaterniond& q : rotations) sum += q.toRotationMatrix();
  return Eigen::Quaterniond(nearestRotation(sum)).normalized();
}

}  // namespace raven_correction
