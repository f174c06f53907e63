// SPDX-License-Identifier: BSD-3-Clause
// What a command asks of each arm, and the same command with other poses, for every message type
// that robots take commands in: PoseStamped, TransformStamped, RavenCommand (raven_command.h).
// Topics that are only listened to are pose_subscription.h.
#pragma once

#include <geometry_msgs/PoseStamped.h>
#include <geometry_msgs/TransformStamped.h>

#include <string>

#include "raven_correction/ros/raven_command.h"

namespace raven_correction {

struct ArmRequest {
  enum class Kind {
    kAbsent,    ///< the message does not name the arm
    kInactive,  ///< nothing is asked of the pose of the arm: it or its pose is off, the pedal is up
    kRelative,  ///< at least one part of the pose is an increment
    kPose,      ///< an absolute pose, or one part of it
  };
  Kind kind = Kind::kAbsent;
  Pose pose;                ///< parts that are not asked for are of no meaning, perhaps not finite
  bool position = true;     ///< part of the request
  bool orientation = true;  ///< part of the request
  bool position_relative = false;     ///< an increment
  bool orientation_relative = false;  ///< an increment
  std::size_t place = 0;              ///< in the message, for write()
};

constexpr std::size_t kMaxCorrectedArms = 2;

struct CommandRequest {
  ros::Time stamp;
  std::string_view frame;  ///< as sent; points into the message
  std::array<ArmRequest, kMaxCorrectedArms> arms;
};

/// "PoseStamped", "TransformStamped" and "RavenCommand".
const std::vector<std::string>& commandTypes();

/// Reads `arm_names.size()` requests. A message with one pose is for the first arm, whatever it is
/// called. No allocation. @return false if the message is malformed
bool readCommand(const geometry_msgs::PoseStamped& message,
                 const std::vector<std::string>& arm_names, CommandRequest& request) noexcept;
bool readCommand(const geometry_msgs::TransformStamped& message,
                 const std::vector<std::string>& arm_names, CommandRequest& request) noexcept;
bool readCommand(const RavenCommand& message, const std::vector<std::string>& arm_names,
                 CommandRequest& request) noexcept;

/// Writes the parts of `pose` that were asked for, and nothing else.
/// @param request  of the same message
void writeCommand(geometry_msgs::PoseStamped& message, const ArmRequest& request,
                  const Pose& pose) noexcept;
void writeCommand(geometry_msgs::TransformStamped& message, const ArmRequest& request,
                  const Pose& pose) noexcept;
void writeCommand(RavenCommand& message, const ArmRequest& request, const Pose& pose) noexcept;

}  // namespace raven_correction
