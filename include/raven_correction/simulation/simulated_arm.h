// SPDX-License-Identifier: BSD-3-Clause
// One simulated arm: takes stamped commands, moves on to any instant, and says where the tool
// really is and where the encoders believe it to be. Used offline and from a real-time loop alike;
// sessions of many trajectories are session.h.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <deque>
#include <memory>
#include <vector>

#include "raven_correction/geometry/stream.h"
#include "raven_correction/robot/inverse_kinematics.h"
#include "raven_correction/simulation/simulation_config.h"

namespace raven_correction {

/// Everything that the future of the arm depends on besides its configuration and its commands.
/// Copy it to go back to it later.
struct ArmState {
  struct Setpoint {
    double stamp;        ///< of the command [s]
    JointVector joints;  ///< nominal inverse kinematics of its pose
  };
  struct JawSetpoint {
    double stamp;    ///< of the command [s]
    double opening;  ///< [rad]
  };
  double start = 0.0;                    ///< of the session; creep and shifts count from here [s]
  double time = 0.0;                     ///< [s]
  JointVector setpoint;                  ///< what the drives aim at now
  JointVector motor;                     ///< motor side in joint units: what the encoders see
  JointVector joint;                     ///< joint side: where the links are
  Setpoint active;                       ///< the command whose delay has passed last
  std::deque<Setpoint> pending;          ///< commands that do not act yet, oldest first
  JointVector command_joints;            ///< of the command taken last: the next one's seed
  double last_stamp = 0.0;               ///< of the command taken last [s]
  std::vector<JointVector> memory;       ///< one per effect
  GripperState gripper;                  ///< a pose does not hold it: it is carried along
  std::vector<JawSetpoint> pending_jaw;  ///< that do not act yet, oldest first
  double last_jaw_stamp = 0.0;           ///< of the jaw command taken last [s]
};

/// Deterministic. Every operator is exact for set-points that are held, so results do not depend on
/// the internal step nor on how often one asks, with three exceptions: backlash behind
/// joint_coupling (the sum of two joints may turn round within a step), the load of cable_stretch
/// (it is that of the step before) and motor_saturation (the other joints are taken to move on
/// evenly within a step). Not thread-safe.
class SimulatedArm {
 public:
  /// Starts at rest at the homing position.
  explicit SimulatedArm(const SimulationConfig& config, double start = 0.0);

  /// Forgets all commands and puts the arm at rest at these joints (nominal, set-point side).
  void reset(double start, const JointVector& joints);
  void reset(double start) { reset(start, config_.robot.home()); }
  /// Puts the arm at rest where the nominal robot has its tool at this pose.
  /// @return status of the inverse kinematics; nothing changes unless the pose was reproduced
  IkStatus reset(double start, const Pose& X_base_tool);

  /// What changes over the session (creep, a shift of the registration) counts from here, not from
  /// reset(): an arm may rest before anybody records. Until then it is as at the start.
  void startSession(double time) noexcept { state_.start = time; }

  /// Takes a command. It acts at its stamp plus the delay, and not before time(). A joint that the
  /// pose would bring outside its limits stops at the limit, as the robot's controller does it.
  /// A pose that cannot be reached, a stamp that runs backwards or is not finite: nothing changes.
  /// @return kOk, kOutsideLimits or kSingular when taken
  IkStatus command(const StampedPose& X_base_tool) noexcept;
  /// Takes a command that is in joints already, as it is: no inverse kinematics, no limits.
  /// @return false, and nothing changes: a stamp that runs backwards or is not finite, joints that
  ///         are not finite or of another number
  bool command(double stamp, const JointVector& joints) noexcept;
  /// Takes a command for the jaw, which acts when a pose with this stamp would. An opening beyond
  /// the gripper's limits stops at the limit. Poses leave the jaw as it is.
  /// @param opening  [rad]
  /// @return false, and nothing changes: a stamp that runs backwards, or a value that is not finite
  bool commandJaw(double stamp, double opening) noexcept;
  /// Moves on to `time`; an earlier one than time() changes nothing. About 1 us per ms simulated.
  void advanceTo(double time) noexcept;

  double time() const noexcept { return state_.time; }
  /// The tool as registered motion capture sees it, without noise: X_base_tool.
  Pose toolPose() const noexcept { return toolPoseAt(sinceStart(), state_.joint); }
  /// The same where the links are at `joints`, so long after the start of the session [s], whatever
  /// the arm does now.
  Pose toolPoseAt(double since_start, const JointVector& joints) const noexcept;
  double sinceStart() const noexcept { return std::max(0.0, state_.time - state_.start); }  ///< [s]
  /// Nominal forward kinematics of the encoders (measured_cp).
  Pose measuredPose() const noexcept { return config_.robot.forward(encoderJoints()); }
  /// Nominal forward kinematics of the present set-point (setpoint_cp).
  Pose setpointPose() const noexcept { return config_.robot.forward(state_.setpoint); }
  const JointVector& setpointJoints() const noexcept { return state_.setpoint; }
  /// What the encoders report (measured_js): motorJoints(), in whole counts if so configured.
  JointVector encoderJoints() const noexcept;
  const JointVector& motorJoints() const noexcept { return state_.motor; }
  const JointVector& joints() const noexcept { return state_.joint; }

  /// Opening of the jaw [rad] and the mass that it holds [kg]; see gripper.h.
  double jaw() const noexcept { return state_.gripper.opening; }
  double payload() const noexcept { return state_.gripper.payload; }

  const ArmState& state() const noexcept { return state_; }
  void restore(const ArmState& state) { state_ = state; }
  const SimulationConfig& config() const noexcept { return config_; }
  /// Commands so far, by their IkStatus (index: the enumerator).
  const std::array<std::uint64_t, 5>& commandCounts() const noexcept { return counts_; }

 private:
  bool accepts(double stamp) const noexcept;
  void enqueue(double stamp, const JointVector& joints) noexcept;
  void activateDue() noexcept;
  StepContext contextOf(double end, double step, const JointVector& load) const noexcept;
  void step(double end) noexcept;
  void runStages(const StepContext& context, bool at_reset, JointVector& q) noexcept;
  JointVector setpointAt(double time) const noexcept;
  JointVector load() const noexcept;

  SimulationConfig config_;
  InverseKinematics ik_;
  KinematicChain real_chain_;  // with all link errors
  double delay_ = 0.0;         // [s]
  Pose X_base_robot_;
  Pose X_tool_observed_;
  bool needs_load_ = false;
  JointMatrix motor_travel_;  // empty: the robot's file has no transmission
  ArmState state_;
  std::array<std::uint64_t, 5> counts_{};
};

}  // namespace raven_correction
