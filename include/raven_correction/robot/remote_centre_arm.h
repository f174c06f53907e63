// SPDX-License-Identifier: BSD-3-Clause
// Closed-form inverse kinematics of arms that pivot about a remote centre: two axes and the shaft
// meet in one point, the pitch axis crosses the shaft, the yaw axis is at right angles to it. The
// Raven II and the da Vinci PSM are such arms. Choosing among the solutions: inverse_kinematics.h.
#pragma once

#include <array>
#include <memory>

#include "raven_correction/robot/kinematic_chain.h"

namespace raven_correction {

/// Rows: revolute, revolute, then roll and insertion along one axis in either order, pitch, yaw.
///
/// With the remote centre as origin, the plane at right angles to the pitch axis holds the tool's
/// yaw axis z, the yaw point p and the shaft. So the link between both wrist axes, length w, is
///   x = +-(p - (p.z) z) / |...|,    pitch point P = p - w x,    insertion s = +-|P|,
/// the shaft is P / s, and the angle of the second axis follows from its inclination,
///   cos(theta_2) = (cos(a_2) cos(a_3) - shaft_z) / (sin(a_2) sin(a_3)),
/// with two signs again: eight candidates, each completed by angles between known directions.
class RemoteCentreArm {
 public:
  using Solutions = std::array<JointVector, 8>;

  /// Null if the chain does not have this form.
  static std::shared_ptr<const RemoteCentreArm> make(const KinematicChain& chain);

  /// All joint vectors that put the tool at the pose, limits not applied, angles within a few turns
  /// of zero. Where a joint is undetermined (pitch axis at the remote centre) it is as in the seed.
  /// @return how many there are, 0 to 8; 0 where the pose cannot be reached
  int solve(const Pose& X_base_tool, const JointVector& seed, Solutions& solutions) const noexcept;

 private:
  RemoteCentreArm() = default;
  Pose X_0_base_;  // includes the first row's alpha
  Pose X_tool_n_;
  int roll_ = 2;  // rows of roll and insertion
  int insertion_ = 3;
  double cos_1_ = 0.0, sin_1_ = 0.0;           // of alpha of the second row
  double cos_2_ = 0.0, sin_2_ = 0.0;           // of alpha of the third row
  double sin_4_ = 0.0, sin_5_ = 0.0;           // of alpha of pitch and yaw: +1 or -1
  double wrist_ = 0.0;                         // pitch axis to yaw axis [m]
  Eigen::Matrix<double, 6, 1> offset_, sign_;  // joint = sign * (geometric - offset)
};

}  // namespace raven_correction
