// SPDX-License-Identifier: BSD-3-Clause
// What the native controller of a robot takes: how far from the tool a command may be, and which
// poses its joints reach. A correction is shortened until it fits (corrector.h); what a controller
// does with a command that does not fit is simulated by ros/command_gate.h.
#pragma once

#include <memory>

#include "raven_correction/robot/inverse_kinematics.h"

namespace raven_correction {

struct RobotLimits {
  double max_step = 0.0;  ///< of the position from where the tool is, >= 0; 0: not checked [m]
  double max_turn = 0.0;  ///< of the orientation likewise, >= 0; 0: not checked [rad]
  /// Joints and their limits, in the base frame of the poses; null: not checked.
  std::shared_ptr<const KinematicChain> chain;
};

struct NearTool {
  Pose command;
  bool shortened_position = false;
  bool shortened_orientation = false;
  bool desired_beyond = false;  ///< the desired pose itself breaks a limit
};

/// The command nearest to `corrected` among those that are as near to the tool as the robot asks
/// for, or as the desired pose is: a projection on a ball about the tool, position and orientation
/// by themselves. So it is never further from the desired pose than `corrected` is, and moves no
/// more than its arguments do.
/// @param tool  where it is, in base
NearTool keepNear(const RobotLimits& limits, const Pose& tool, const Pose& desired,
                  const Pose& corrected) noexcept;

/// Whether the joints reach a pose. Not thread-safe: it follows the motion with its last solution.
class RobotReach {
 public:
  /// @throws InvalidInput  a limit that is negative or not finite
  explicit RobotReach(const RobotLimits& limits);

  bool isChecked() const noexcept { return solver_ != nullptr; }
  /// There are joints inside their limits for the pose; true where nothing is checked. No
  /// allocation; some microseconds in closed form.
  bool reaches(const Pose& pose) noexcept;
  /// The largest s in [0, 1], to 1 %, with which the joints reach the desired pose moved by s times
  /// a correction (translation in base, rotation vector in the tool frame); 0 where they reach
  /// neither of its ends. Between a pose in reach and one out of reach one border is assumed.
  double reachableShare(const Pose& desired, const Eigen::Vector3d& translation,
                        const Eigen::Vector3d& rotation) noexcept;

 private:
  std::unique_ptr<const InverseKinematics> solver_;
  JointVector joints_;
};

}  // namespace raven_correction
