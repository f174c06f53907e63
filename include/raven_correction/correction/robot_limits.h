// SPDX-License-Identifier: BSD-3-Clause
// What the native controller of a robot takes: how far from the tool a command may be, and which
// poses its joints reach. A correction is shortened until it fits (corrector.h); what a controller
// does with a command that does not fit is simulated by ros/command_gate.h.
#pragma once

#include <Eigen/Geometry>
#include <memory>
#include <vector>

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
  bool shortened_position = false;     ///< by max_step
  bool shortened_orientation = false;  ///< by max_turn
  bool shortened_room = false;         ///< the position, by `room`
  bool desired_beyond = false;         ///< the desired pose itself breaks max_step or max_turn
};

/// The command nearest to `corrected` among those inside `room` that are as near to the tool as the
/// robot asks for, or as the desired pose is: the projection of the position on a box and a ball
/// about the tool at once, and of the orientation on a ball. So it is never further from the
/// desired pose than `corrected` is, and moves no more than `corrected` does.
/// @param tool  where it is, in base; null: not known, and only `room` counts
/// @param room  for the position, in base; contains the desired one
NearTool keepNear(const RobotLimits& limits, const Pose* tool, const Eigen::AlignedBox3d& room,
                  const Pose& desired, const Pose& corrected) noexcept;

/// Whether the joints reach a corrected pose by a small motion from those of the planner's own
/// pose: another turn of the tool roll, or the arm folded the other way, would be no correction but
/// a swing through the patient. Not thread-safe. No allocation; some microseconds a pose in closed
/// form, otherwise at most one run of Newton steps from the joints before.
class RobotReach {
 public:
  /// @throws InvalidInput  a limit that is negative or not finite
  explicit RobotReach(const RobotLimits& limits);

  bool isChecked() const noexcept { return solver_ != nullptr; }
  /// The planner's pose that the questions below are about. Its joints are those inside the limits
  /// nearest to the joints of the last one that was committed: where the controller would go.
  void follow(const Pose& desired) noexcept;
  void commit() noexcept { joints_ = followed_; }
  void discard() noexcept { followed_ = joints_; }
  /// There are joints inside their limits for the pose, each revolute one within 90 degrees of
  /// those of the planner's pose; true where nothing is checked.
  bool reaches(const Pose& pose) const noexcept;
  /// The largest s in [0, 1], to 1 %, with which the joints reach the planner's pose moved by s
  /// times a correction (translation in base, rotation vector in the tool frame); 0 where they
  /// reach neither of its ends. Between a pose in reach and one out of reach one border is assumed.
  double reachableShare(const Eigen::Vector3d& translation,
                        const Eigen::Vector3d& rotation) const noexcept;

 private:
  std::unique_ptr<const InverseKinematics> solver_;   // of the planner's pose
  std::unique_ptr<const InverseKinematics> nearest_;  // of what is near to it
  std::vector<bool> revolute_;
  JointVector joints_, followed_;
  Pose desired_;
};

}  // namespace raven_correction
