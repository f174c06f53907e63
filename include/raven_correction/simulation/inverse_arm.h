// SPDX-License-Identifier: BSD-3-Clause
// The way back through the simulated arm: from a tool pose and how it got there to the command that
// a simulation says produced it. From commands to tool poses is simulated_arm.h.
#pragma once

#include <array>
#include <cstddef>

#include "raven_correction/geometry/pose.h"
#include "raven_correction/robot/inverse_kinematics.h"
#include "raven_correction/simulation/simulation_config.h"

namespace raven_correction {

struct InverseTiming {
  double delay = 0.0;  ///< the command wanted is that of `delay` before the newest pose [s]
  double hold = 0.0;   ///< held set-points are on average this much older than a line through the
                       ///< commands, half their period; counts with SetpointMode::kHold only [s]
  /// Age of the session at which creep and shifts are taken, >= 0 [s]. A path does not hold it, and
  /// a robot in use is as it was at the end of its recording, not at the start.
  double age = 0.0;
};

/// Where the tool is and was: corners of its path, straight in joints between them.
struct ToolPath {
  static constexpr std::size_t kMost = 5;
  struct Corner {
    double ago = 0.0;  ///< before now [s]
    Pose pose;         ///< X_base_tool as motion capture saw it, or as it shall see it
  };
  std::array<Corner, kMost> corners;  ///< newest first: ago = 0, then increasing
  std::size_t count = 0;
};

/// Undoes the stages one after the other, the last one first:
///
///   observation, base, tool   closed form
///   links                     inverse kinematics of the real chain, corner by corner
///   joints at the instant     t_e = now - delay + hold + sum of command delays, on the path; their
///                             speed is that of the path from t_e on, over kSpeedTime or to now.
///                             What lies ahead of now goes on at the newest speed, for kMostAhead
///   cables, drives            Effect::undo(), corner by corner up to t_e, so that a play knows
///                             its side
///   command                   nominal forward kinematics
///
/// A function of the path alone, so that a regression which knows the path can learn what is wrong
/// with it: a mean that looks at other samples than the regression adds their noise. Before its
/// oldest corner the tool was at rest. What happened is taken to be what was wanted: where a motor
/// stalled or a joint was at its speed limit, the path does not tell its set-point, and it is taken
/// to be near the joint.
/// Immutable, safe to share between threads; solve() does not allocate.
class InverseArm {
 public:
  /// @throws InvalidInput  no robot, or a time that is not finite or negative where it may not be
  InverseArm(const SimulationConfig& config, const InverseTiming& timing);

  struct Answer {
    bool reached = false;  ///< the simulated robot reaches every corner
    Pose command;          ///< of the instant `delay` before now, X_base_tool
    JointVector setpoint;  ///< its joints; no limit is applied
  };
  Answer solve(const ToolPath& path) const noexcept;

 private:
  static constexpr std::size_t kMostEffects = 24;
  using Joints = std::array<JointVector, ToolPath::kMost>;
  using Memory = std::array<JointVector, kMostEffects>;  // one per effect
  bool jointsOf(const Pose& X_base_tool, const JointVector& seed, bool from_home,
                JointVector& joints) const noexcept;
  JointVector jointsAt(const ToolPath& path, const Joints& joints, double ago) const noexcept;
  void undoStages(bool first, Memory& memory, JointVector& speed, JointVector& q) const noexcept;

  SimulationConfig config_;
  KinematicChain real_chain_;
  InverseKinematics nominal_ik_, real_ik_;
  bool links_differ_ = false;
  Pose X_robot_base_;     // the registered base in the real one
  Pose X_observed_tool_;  // the nominal tool in the observed frame
  bool needs_load_ = false;
  JointMatrix motor_travel_;  // empty: the robot's file has no transmission
  double age_ = 0.0;
  double lead_ = 0.0;  // of now over the instant that is looked at [s]
};

}  // namespace raven_correction
