// SPDX-License-Identifier: BSD-3-Clause
// The motions of a debridement task: to a fragment of the field, up with it, and over to a
// receptacle. The live planner and offline sessions draw them from the same generator.
#pragma once

#include <cstdint>
#include <random>
#include <string>
#include <vector>

#include "raven_correction/geometry/stream.h"
#include "raven_correction/robot/inverse_kinematics.h"

namespace raven_correction {

/// Positions are in the arm's base frame. Defaults: the left Raven of the CASE 2014 session.
struct DebridementConfig {
  Eigen::Vector3d field_centre{-0.020, -0.058, -0.160};  ///< middle of the field of fragments [m]
  Eigen::Vector3d field_size{0.08, 0.08, 0.02};          ///< x, y, z [m]
  Eigen::Vector3d receptacle{-0.020, -0.0203, -0.105};   ///< where fragments are dropped [m]
  Eigen::Vector3d box_lower{-0.083, -0.100, -0.175};     ///< commands stay inside this box [m]
  Eigen::Vector3d box_upper{0.040, -0.017, -0.091};
  Eigen::Quaterniond orientation{0.5084, 0.4938, 0.4797, -0.5173};  ///< mean of the tool
  Eigen::Vector3d orientation_deviation{0.1, 0.1, 0.1};  ///< of its rotation vector per axis [rad]
  double lift_height = 0.05;   ///< above a fragment to look at it, along z [m]
  double speed = 0.08;         ///< along a straight move, in its middle [m/s]
  double angular_speed = 1.0;  ///< the slowest of the three limits sets the time [rad/s]
  double acceleration = 0.5;   ///< largest along a straight move [m/s^2]
  double rate = 50.0;          ///< of commands [Hz]
  double pause = 0.2;          ///< commands before the motion starts, at rest [s]
  double dwell = 0.5;          ///< commands go on at the target for this long [s]
  double jaw_open = 0.8;       ///< opening on the way to a fragment, and to let go of it [rad]
  double jaw_closed = 0.0;     ///< opening that is commanded to hold it [rad]
};

/// Every scalar of the configuration with its key in YAML and its range.
struct DebridementField {
  const char* key;
  double DebridementConfig::*value;
  double lower;
  double upper;
};
const std::vector<DebridementField>& debridementFields();

/// One motion between two rests: a trajectory of the data set.
struct DebridementTrajectory {
  enum class Kind { kMoveTowardsFragment, kCheckPickup, kMoveHolding };
  Kind kind = Kind::kMoveTowardsFragment;
  PoseStream commands;      ///< at `rate`, first stamp = the given start; ends with the dwell
  Pose target;              ///< where it comes to rest
  double rest_start = 0.0;  ///< stamp from which on commands equal `target` [s]
  bool holding = false;     ///< a fragment is in the gripper during the motion
  /// Opening of the jaw that is commanded with each of `commands` [rad]; it changes in the middle
  /// of the dwell, when the tool has come to rest. Empty: the motion leaves the jaw as it is.
  std::vector<double> jaw;
  std::uint64_t fragment = 0;  ///< number of the fragment, from 0
};
/// "move_towards_foam", "check_pickup", "move_holding": the names of the measured session.
const char* toString(DebridementTrajectory::Kind kind) noexcept;

/// Deterministic from its seed and the sequence of calls.
class DebridementMotion {
 public:
  /// @throws InvalidInput  a value out of range, or a field that the robot cannot reach
  DebridementMotion(const DebridementConfig& config, const KinematicChain& robot,
                    std::uint64_t seed);
  /// Where the tool rests between trajectories: the end of the last one, or the first start.
  const Pose& rest() const noexcept { return rest_; }
  /// The next motion, in the cycle towards, check pickup, holding.
  /// @param start  stamp of its first command [s]
  DebridementTrajectory next(double start);
  /// A random pose over the field that the robot can reach, e.g. as a target of one's own.
  Pose randomTarget();
  /// The robot's joints reach the pose. Commands also stay in the box, whatever the target.
  bool isReachable(const Pose& X_base_tool) const;
  /// A motion from rest() to `target`, with the same speed profile and without the jaw; becomes the
  /// new rest.
  DebridementTrajectory moveTo(const Pose& target, double start);

 private:
  struct Move {  // a minimum-jerk displacement that starts at `begin` [s]
    double begin;
    double duration;
    Eigen::Vector3d translation;  // [m]
    Eigen::Vector3d rotation;     // rotation vector, in the tool frame at its start [rad]
  };
  double durationOf(const Pose& from, const Pose& to) const;
  Pose randomPose(const Eigen::Vector3d& centre, const Eigen::Vector3d& size);
  DebridementTrajectory follow(const std::vector<Pose>& waypoints, double start);
  void addJaw(double before, double after, DebridementTrajectory& trajectory) const;

  DebridementConfig config_;
  KinematicChain robot_;
  InverseKinematics ik_;
  std::mt19937_64 random_;
  Pose rest_;
  Pose fragment_pose_;
  std::uint64_t fragments_ = 0;
  int phase_ = 0;
};

}  // namespace raven_correction
