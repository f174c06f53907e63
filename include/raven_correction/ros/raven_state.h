// SPDX-License-Identifier: BSD-3-Clause
// Where an arm is by its encoders, from the state messages of both Raven stacks, without their
// packages and in metres and radians: raven_2/raven_state (UW) speaks in micrometres and degrees.
// Whether the robot is homed is robot_state.h, which reads the same messages.
#pragma once

#include <ros/time.h>

#include <optional>
#include <string>
#include <vector>

#include "raven_correction/geometry/pose.h"

namespace raven_correction {

struct ArmMeasurement {
  ros::Time stamp;
  std::string frame;  ///< as sent; UW: empty
  Pose tool;          ///< forward kinematics of the encoders [m]; not of unit length: no rotation
  /// Names as in config/robots: shoulder, elbow, insertion, tool_roll, wrist_pitch, finger_1,
  /// finger_2, and wrist_yaw = (finger_2 - finger_1) / 2.
  std::vector<std::string> joint_names;
  std::vector<double> positions;  ///< [rad, m]
};

/// raven_2/raven_state: arms are "gold" (or "left", "L") and "green" ("right", "R"), each in its
/// own frame 0. pos in micrometres; jpos is value * 180/pi of every joint, the insertion in metres
/// included. raven_2_msgs/RavenState: arms by the names that it has ("L", "R"), in metres and
/// radians.
/// @param md5sum  of the message, from its connection header
/// @return nothing for another type, bytes that are too few or too many, or an arm that is not
/// there
std::optional<ArmMeasurement> readArmMeasurement(const std::string& md5sum,
                                                 const std::vector<std::uint8_t>& bytes,
                                                 const std::string& arm);

}  // namespace raven_correction
