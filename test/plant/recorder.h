// SPDX-License-Identifier: BSD-3-Clause
// Runs the plant through a motion and notes what perfect instruments would read: the common part of
// session.h (seen by cameras) and joint_session.h (joints alone).
#pragma once

#include <cstdint>
#include <vector>

#include "plant/motion.h"
#include "plant/robot_plant.h"

namespace raven_correction::plant {

struct RecorderOptions {
  double frame_rate = 110.0;   ///< exposures [Hz]
  double encoder_rate = 50.0;  ///< [Hz]
  std::uint64_t seed = 1;      ///< of the phases of both
};

/// Streams from the first to the last command of one trajectory.
struct RecordedTrajectory {
  // at every exposure
  PoseStream observed;
  PoseStream motor_poses;
  std::vector<StampedJoints> joints;
  // at the encoders' own instants, in whole counts (20 urad, 1 um)
  std::vector<StampedJoints> encoders;
};
struct Recording {
  std::vector<RecordedTrajectory> trajectories;
};

/// The arm comes from `motion.approach` in two seconds, so plays start on a random side.
Recording record(const RobotPhysics& physics, const Motion& motion, const RecorderOptions& options);

/// Nominal set-points of a trajectory, with the names of the chain's joints.
JointStream jointCommands(const KinematicChain& robot, const PlannedTrajectory& trajectory);

}  // namespace raven_correction::plant
