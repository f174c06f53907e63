// SPDX-License-Identifier: BSD-3-Clause
// Pose, twist and their pair, the state x = (p, dp/dt) of the design. Time-stamped sequences of
// poses are in stream.h.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "raven_correction/geometry/rotation.h"

namespace raven_correction {

/// A rigid transform X_a_b: the pose of frame b in frame a.
struct Pose {
  Eigen::Vector3d p = Eigen::Vector3d::Zero();            ///< origin of b in a [m]
  Eigen::Quaterniond q = Eigen::Quaterniond::Identity();  ///< axes of b in a, unit

  /// X_a_c = X_a_b * X_b_c
  Pose operator*(const Pose& X_b_c) const noexcept { return {p + q * X_b_c.p, q * X_b_c.q}; }
  /// A point of b, in a [m].
  Eigen::Vector3d operator*(const Eigen::Vector3d& p_b) const noexcept { return p + q * p_b; }
  /// X_b_a
  Pose inverse() const noexcept { return {-(q.conjugate() * p), q.conjugate()}; }
  Eigen::Isometry3d isometry() const { return Eigen::Translation3d(p) * q; }
  static Pose fromIsometry(const Eigen::Isometry3d& X) {
    return {X.translation(), Eigen::Quaterniond(X.linear()).normalized()};
  }
};

/// Velocity of a body frame, both parts expressed in the base frame.
struct Twist {
  Eigen::Vector3d v = Eigen::Vector3d::Zero();  ///< of the origin [m/s]
  Eigen::Vector3d w = Eigen::Vector3d::Zero();  ///< angular velocity [rad/s]
};

/// The state x of the design (section 1): where the tool is and how it moves, in R^12.
struct State {
  Pose pose;
  Twist twist;
};

/// Largest | |q| - 1 | of a quaternion that is still taken for a rotation.
constexpr double kUnitTolerance = 1e-3;

bool isFinite(const Pose& pose) noexcept;
/// | |q| - 1 | <= kUnitTolerance; false for NaN.
bool hasUnitQuaternion(const Pose& pose) noexcept;
/// True for the pose (0,0,0; 0,0,0,1) exactly: what a controller sends before it knows better.
bool isIdentity(const Pose& pose) noexcept;

/// Between a (s = 0) and b (s = 1): position linearly, orientation at constant angular velocity
/// along the shorter arc. s outside [0, 1] extrapolates.
Pose interpolate(const Pose& a, const Pose& b, double s) noexcept;

}  // namespace raven_correction
