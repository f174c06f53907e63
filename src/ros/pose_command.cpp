// SPDX-License-Identifier: BSD-3-Clause
#include "raven_correction/ros/pose_command.h"

#include <algorithm>

#include "raven_correction/ros/conversions.h"

namespace raven_correction {
namespace {

template <typename Message, typename Geometry>
bool readSingle(const Message& message, const Geometry& geometry,
                CommandRequest& request) noexcept {
  request.stamp = message.header.stamp;
  request.frame = message.header.frame_id;
  request.arms[0] = {};
  request.arms[0].kind = ArmRequest::Kind::kPose;
  request.arms[0].pose = poseFromMsg(geometry);
  return true;
}

ArmRequest requestOf(const RavenArmCommand& arm, bool pedal_down) noexcept {
  ArmRequest request;
  request.pose = arm.pose;
  request.place = arm.place;
  request.position = (arm.pose_option & kRavenPositionEnabled) != 0;
  request.orientation = (arm.pose_option & kRavenOrientationEnabled) != 0;
  request.position_relative = request.position && (arm.pose_option & kRavenPositionRelative) != 0;
  request.orientation_relative =
      request.orientation && (arm.pose_option & kRavenOrientationRelative) != 0;
  if (!pedal_down || !arm.active || !(request.position || request.orientation))
    request.kind = ArmRequest::Kind::kInactive;
  else
    request.kind = request.position_relative || request.orientation_relative
                       ? ArmRequest::Kind::kRelative
                       : ArmRequest::Kind::kPose;
  return request;
}

}  // namespace

const std::vector<std::string>& commandTypes() {
  static const std::vector<std::string> types{"PoseStamped", "TransformStamped", "RavenCommand"};
  return types;
}

bool readCommand(const geometry_msgs::PoseStamped& message, const std::vector<std::string>&,
                 CommandRequest& request) noexcept {
  return readSingle(message, message.pose, request);
}

bool readCommand(const geometry_msgs::TransformStamped& message, const std::vector<std::string>&,
                 CommandRequest& request) noexcept {
  return readSingle(message, message.transform, request);
}

bool readCommand(const RavenCommand& message, const std::vector<std::string>& arm_names,
                 CommandRequest& request) noexcept {
  RavenCommandContent content;
  if (!readRavenCommand(message.bytes, content)) return false;
  request.stamp = content.stamp;
  request.frame = content.frame;
  for (std::size_t i = 0; i < arm_names.size(); ++i) {
    const auto end = content.arms.begin() + static_cast<std::ptrdiff_t>(content.arm_count);
    const auto found = std::find_if(content.arms.begin(), end, [&](const RavenArmCommand& arm) {
      return arm.name == arm_names[i];
    });
    request.arms[i] = found == end ? ArmRequest() : requestOf(*found, content.pedal_down);
  }
  return true;
}

void writeCommand(geometry_msgs::PoseStamped& message, const ArmRequest&,
                  const Pose& pose) noexcept {
  message.pose = poseToMsg(pose);
}

void writeCommand(geometry_msgs::TransformStamped& message, const ArmRequest&,
                  const Pose& pose) noexcept {
  message.transform = transformToMsg(pose);
}

void writeCommand(RavenCommand& message, const ArmRequest& request, const Pose& pose) noexcept {
  writeRavenPose(message.bytes, request.place, pose, request.position, request.orientation);
}

}  // namespace raven_correction
