// SPDX-License-Identifier: BSD-3-Clause
// Charts of SO(3): rotation vector, ZYX angles, mean rotation. Poses are in pose.h.
// Quaternions are Eigen's: constructed w,x,y,z; coeffs() and messages x,y,z,w.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <vector>

namespace raven_correction {

/// Rotation by |r| about r/|r|. Exact series near zero; any finite length is allowed.
/// @param r  rotation vector [rad]
Eigen::Quaterniond expRotation(const Eigen::Vector3d& r) noexcept;

/// The rotation vector of q, of length in [0, pi] [rad]; inverse of expRotation() below pi, and
/// accurate to rounding near 0 and near pi. At exactly pi one of the two equal vectors.
/// @param q  unit quaternion; q and -q give the same vector
Eigen::Vector3d logRotation(const Eigen::Quaterniond& q) noexcept;

/// Angle of inv(a) b, in [0, pi] [rad].
double rotationAngle(const Eigen::Quaterniond& a, const Eigen::Quaterniond& b) noexcept;

/// Yaw, pitch, roll of R = Rz(yaw) Ry(pitch) Rx(roll), in that order [rad]; yaw and roll in
/// (-pi, pi], pitch in [-pi/2, pi/2]. At pitch = +-pi/2 only one of yaw and roll is determined:
/// roll is then 0.
Eigen::Vector3d zyxAngles(const Eigen::Matrix3d& R) noexcept;

/// The rotation nearest to M in the Frobenius norm: U diag(1,1,det(U V^T)) V^T of its SVD. The
/// determinant keeps the result a rotation where M is nearer to a mirror image.
/// Source: Umeyama 1991, doi:10.1109/34.88573
Eigen::Matrix3d nearestRotation(const Eigen::Matrix3d& M);

/// Chordal mean: the rotation nearest to the arithmetic mean of the rotation matrices.
/// @throws InvalidInput  for an empty list
/// Source: Moakher 2002, doi:10.1137/S0895479801383877
Eigen::Quaterniond meanRotation(const std::vector<Eigen::Quaterniond>& rotations);

}  // namespace raven_correction
