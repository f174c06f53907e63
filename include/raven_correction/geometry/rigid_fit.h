// SPDX-License-Identifier: BSD-3-Clause
// The rigid transform that best maps one list of poses onto another, by least squares in closed
// form. Finding the poses worth fitting is the room `cleaning`.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "raven_correction/geometry/pose.h"

namespace raven_correction {

struct RigidFitProblem {
  std::vector<Pose> from;  ///< X_a_body, N poses
  std::vector<Pose> to;    ///< X_b_body, the same instants
  /// Weight of the rotation entries against the translation entries: an entry of a rotation matrix
  /// counts as much as this length. 1 m is the plain Frobenius norm of the paper; 0 fits points.
  double rotation_length = 0.05;  ///< >= 0 [m]
};

struct RigidFitResult {
  enum class Status { kNotRun, kOk, kDegenerate };
  Status status = Status::kNotRun;
  Pose X_b_a;                 ///< to ~ X_b_a * from
  double rms_position = 0.0;  ///< of | p_to - X_b_a p_from | [m]
  double rms_angle = 0.0;     ///< of the angle between to and X_b_a from [rad]
};

/// Minimises over X_b_a = (R, t)
///
///   sum_i || R p_i + t - p'_i ||^2 + L^2 || R R_i - R'_i ||_F^2
///   H = sum_i (p'_i - mean') (p_i - mean)^T + L^2 R'_i R_i^T = U S V^T
///   R = U diag(1, 1, det(U V^T)) V^T,   t = mean' - R mean
///
/// with L the rotation length. The determinant keeps R a rotation where noise would prefer a mirror
/// image. With L > 0 a single pose determines the transform; with L = 0 three points do, and
/// kDegenerate says that they are on a line (R is then one of many).
/// @throws InvalidInput  sizes differ, no pose, or a pose that is not finite (the text has its
/// index) Source: Mahler et al. 2014, section IV-A; Arun et al. 1987,
/// doi:10.1109/TPAMI.1987.4767965; the
///         mirror case: Umeyama 1991, doi:10.1109/34.88573
RigidFitResult fitRigid(const RigidFitProblem& problem);

}  // namespace raven_correction
