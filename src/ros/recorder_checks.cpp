// SPDX-License-Identifier: BSD-3-Clause
// What the node `recorder` hands to the checks of its streams, and what it takes from the robot's
// state.
#include <std_msgs/Header.h>

#include <boost/make_shared.hpp>

#include "raven_correction/error.h"
#include "raven_correction/ros/arm_kinematics.h"
#include "raven_correction/ros/conversions.h"
#include "raven_correction/ros/names.h"
#include "raven_correction/ros/raven_state.h"
#include "raven_correction/ros/recorder.h"
#include "raven_correction/ros/topics.h"

namespace raven_correction {
namespace {

constexpr std::size_t kCheckedSamples = 4096;  // newest ones of each stream [1]

}  // namespace

void Recorder::startChecks() {
  StreamCheckOptions options;
  options.window = kCheckedSamples;
  options.base_frame = params_.base_frame;
  options.arms = loadArms(params_.robot, params_.other_robots, params_.base_frame);
  const std::pair<StreamRole, Stream> roles[] = {{StreamRole::kCommands, kCommand},
                                                 {StreamRole::kObservations, kMocap},
                                                 {StreamRole::kEncoders, kEncoder},
                                                 {StreamRole::kJoints, kJoints}};
  for (const auto& [role, stream] : roles)
    options.names[static_cast<std::size_t>(role)] = streams_[stream].subscriber.getTopic();
  const auto datatype = [](const std::string& type) {
    return (type == "RavenCommand" ? "raven_2_msgs/" : "geometry_msgs/") + type;
  };
  watch_ = std::make_unique<StreamWatch>(
      options, std::vector<TopicType>{
                   {streams_[kCommand].subscriber.getTopic(), datatype(params_.command_type)},
                   {streams_[kMocap].subscriber.getTopic(), datatype(params_.mocap_pose_type)}});
}

std::optional<Pose> Recorder::check(StreamRole role, const ros::Time& arrival,
                                    const geometry_msgs::PoseStamped& message) {
  const auto X_base_frame = registration_.find(message.header.frame_id);
  watch_->addPose(role, message.header.stamp.toSec(), arrival.toSec(),
                  withoutSlash(message.header.frame_id), poseFromMsg(message.pose),
                  X_base_frame ? &*X_base_frame : nullptr);
  return X_base_frame;
}

/// One message that says all of a Raven: whether it is homed, and where its arm is.
void Recorder::onRobotState(const ros::MessageEvent<AnyMessage const>& event) {
  const auto md5sum = event.getConnectionHeader().find("md5sum");
  const std::string type =
      md5sum == event.getConnectionHeader().end() ? std::string() : md5sum->second;
  const std::vector<std::uint8_t>& bytes = event.getConstMessage()->bytes;
  const auto state = readRobotState(type, bytes);
  const bool takes_arm = !params_.robot_state_arm.empty();
  const auto arm = takes_arm ? readArmMeasurement(type, bytes, params_.robot_state_arm)
                             : std::optional<ArmMeasurement>();
  if ((!state || takes_arm != arm.has_value()) && !robot_state_warned_) {
    robot_state_warned_ = true;
    ROS_ERROR(
        "recorder: %s %s; expected %s", robot_state_subscriber_.getTopic().c_str(),
        state ? format("says nothing of an arm \"%s\"", params_.robot_state_arm.c_str()).c_str()
              : "has a type that says nothing of a robot's state",
        takes_arm ? "raven_2_msgs/RavenState or raven_2/raven_state, and an arm of it in "
                    "~robot_state_arm"
                  : "crtk_msgs/operating_state, raven_2_msgs/RavenState or raven_2/raven_state");
  }
  // By its arrival: this thread may be held up by a disk.
  const auto homing = state ? homing_watch_.update(*state, event.getReceiptTime().toSec())
                            : HomingWatch::Homing::kNone;
  if (homing != HomingWatch::Homing::kNone) {
    homed_at_ = event.getReceiptTime();
    ROS_WARN("recorder: the robot %s", homingText(homing));
    recordHoming(homed_at_);
  }
  if (!arm) return;
  const auto pose = boost::make_shared<geometry_msgs::PoseStamped>(stampedPoseToMsg(
      0.0, arm->tool, arm->frame.empty() ? params_.robot_state_frame : arm->frame));
  pose->header.stamp = arm->stamp;
  onEncoder(pose);
  const auto joints = boost::make_shared<sensor_msgs::JointState>();
  joints->header.stamp = arm->stamp;
  joints->name = arm->joint_names;
  joints->position = arm->positions;
  onJoints(kJoints, joints);
}

/// A bag says when the robot was homed last: what is learnt from it is of no use after the next.
void Recorder::recordHoming(const ros::Time& time) {
  if (!recording_ || homed_at_.isZero()) return;
  const auto homing = boost::make_shared<std_msgs::Header>();
  homing->stamp = homed_at_;
  writer_->pushSticky(
      makeBagRecord<std_msgs::Header>(topics::kRobotHomed, time, homing, /*latched=*/true));
}

}  // namespace raven_correction
