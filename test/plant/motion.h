// SPDX-License-Identifier: BSD-3-Clause
// Commands of a session: point-to-point motions over a working field that move every joint in both
// directions, at several speeds, with pauses at both ends. What the robot makes of them is
// robot_plant.h.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "raven_correction/geometry/stream.h"
#include "raven_correction/robot/kinematic_chain.h"

namespace raven_correction::plant {

struct MotionOptions {
  int trajectories = 40;       ///< > 0
  double rate = 60.0;          ///< of commands [Hz]
  double stamp_jitter = 1e-3;  ///< largest deviation of a stamp from the even grid [s]
  double start = 1000.0;       ///< stamp of the first command [s]
  /// Whole range of positions along x, y, z of `base` [m], and of each component of the rotation
  /// vector of the tool [rad].
  Eigen::Vector3d field_size{0.08, 0.08, 0.05};
  double orientation_range = 0.8;
  std::uint64_t seed = 1;
};

struct PlannedTrajectory {
  std::string id;
  PoseStream commands;              ///< nominal tool poses, in `base`
  std::vector<JointVector> joints;  ///< nominal inverse kinematics of each command
};

struct Motion {
  JointVector approach;  ///< where the arm comes from before the first trajectory
  std::vector<PlannedTrajectory> trajectories;
  Eigen::Vector3d middle;    ///< of the field, in `base` [m]
  JointVector joint_middle;  ///< median of the commanded joints
  JointVector joint_span;    ///< from their 5 % to their 95 % quantile
  double start() const { return trajectories.front().commands.front().stamp; }
  double duration() const { return trajectories.back().commands.back().stamp - start(); }
};

/// Trajectories of 1.5 to 4 s, one to three straight moves each. Peak speeds 10 to 130 mm/s with
/// accelerations of 0.3 to 1.2 m/s^2, turns at 12 rad/m of it; trajectories start where the last
/// one ended, 0.3 to 1 s later. The field of `raven2_left` is that of the CASE 2014 session; other
/// robots work about a posture near their home.
/// @throws InvalidInput  trajectories or rate not > 0, or a field that the robot cannot reach
Motion planMotion(const KinematicChain& robot, const MotionOptions& options);

/// The same for joints alone: two moves in each trajectory, poses are the identity.
/// @param amplitude  how far each joint moves to either side of 0
/// @param stops      a move is a dozen stops, one command each, instead of an even motion
Motion planJointMotion(const JointVector& amplitude, bool stops, const MotionOptions& options);

}  // namespace raven_correction::plant
