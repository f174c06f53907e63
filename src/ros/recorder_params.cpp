// SPDX-License-Identifier: BSD-3-Clause
// Parameters of the node `recorder`: from the parameter server, and as text for the bag.
#include <yaml-cpp/yaml.h>

#include <filesystem>

#include "raven_correction/error.h"
#include "raven_correction/ros/names.h"
#include "raven_correction/ros/params.h"
#include "raven_correction/ros/pose_command.h"
#include "raven_correction/ros/pose_subscription.h"
#include "raven_correction/ros/recorder.h"

namespace raven_correction {

RecorderParams loadRecorderParams(const ros::NodeHandle& nh) {
  RecorderParams params;
  params.directory = "~/raven_sessions";
  std::vector<std::string> mocap_types = poseTypes(), types = commandTypes();
  mocap_types.insert(mocap_types.begin(), "same");
  types.insert(types.begin(), "same");
  ParamReader read(nh, "recorder");
  read.text("directory", params.directory);
  read.flag("auto_start", params.auto_start);
  read.text("base_frame", params.base_frame);
  read.oneOf("pose_type", params.pose_type, poseTypes());
  read.oneOf("command_type", params.command_type, types);
  read.text("command_arm", params.command_arm);
  read.oneOf("mocap_pose_type", params.mocap_pose_type, mocap_types);
  read.text("mocap_frame", params.mocap_frame);
  read.oneOf("mocap_stamp", params.mocap_stamp, {"header", "receipt"});
  read.text("robot_state_topic", params.robot_state_topic);
  read.positive("robot_state_timeout", params.robot_state_timeout, 60.0);
  read.text("robot_state_arm", params.robot_state_arm);
  read.text("robot_state_frame", params.robot_state_frame);
  read.text("robot", params.robot);
  read.texts("other_robots", params.other_robots);
  read.number("max_gap", params.pairs.max_gap, 0.0, 10.0);
  read.positive("max_gap_periods", params.pairs.max_gap_periods, 100.0);
  read.positive("pair_horizon", params.pairs.horizon, 60.0);
  read.positive("delay_window", params.delay.window, 600.0);
  read.number("max_delay_change", params.delay.max_change, 0.0, DelayWatch::kRange);
  read.number("split_size_mb", params.split_size_mb, 0.0, 1e6);
  read.number("split_duration", params.split_duration, 0.0, 1e6);
  read.number("min_free_mb", params.min_free_mb, 0.0, 1e6);
  read.integer("queue_size", params.queue_size, 1000, 10000000);
  read.integer("subscriber_queue", params.subscriber_queue, 100, 1000000);
  read.refuseUnknownKeys({"diagnostic_period"});
  read.throwIfAnyProblem();
  params.directory =
      std::filesystem::absolute(expandHome(params.directory)).lexically_normal().string();
  params.base_frame = withoutSlash(params.base_frame);
  if (params.base_frame.empty())
    throw InvalidInput("recorder: ~base_frame is empty; give the frame of servo_cp, e.g. 0_link");
  if (params.command_type == "RavenCommand" && params.command_arm.empty())
    throw InvalidInput(
        "recorder: ~command_arm is empty; say which arm of the RavenCommand is recorded, e.g. L");
  if (!params.robot_state_arm.empty() && params.robot_state_topic.empty())
    throw InvalidInput(
        "recorder: ~robot_state_arm is set and ~robot_state_topic is not; give the topic of the "
        "robot's state, e.g. raven_state or ravenstate");
  if (params.command_type == "same") params.command_type = params.pose_type;
  if (params.mocap_pose_type == "same") params.mocap_pose_type = params.pose_type;
  ROS_INFO_STREAM(read.summary());
  return params;
}

std::string recorderParametersYaml(const RecorderParams& params) {
  YAML::Emitter out;
  out << YAML::BeginMap;
  const auto add = [&out](const char* key, const auto& value) {
    out << YAML::Key << key << YAML::Value << value;
  };
  add("package", "raven_correction");
  add("version", RAVEN_CORRECTION_VERSION);
  add("directory", params.directory);
  add("auto_start", params.auto_start);
  add("base_frame", params.base_frame);
  add("pose_type", params.pose_type);
  add("command_type", params.command_type);
  add("command_arm", params.command_arm);
  add("mocap_pose_type", params.mocap_pose_type);
  add("mocap_frame", params.mocap_frame);
  add("mocap_stamp", params.mocap_stamp);
  add("robot_state_topic", params.robot_state_topic);
  add("robot_state_timeout", params.robot_state_timeout);
  add("robot_state_arm", params.robot_state_arm);
  add("robot_state_frame", params.robot_state_frame);
  add("robot", params.robot);
  out << YAML::Key << "other_robots" << YAML::Value << YAML::Flow << params.other_robots;
  add("max_gap", params.pairs.max_gap);
  add("max_gap_periods", params.pairs.max_gap_periods);
  add("pair_horizon", params.pairs.horizon);
  add("delay_window", params.delay.window);
  add("max_delay_change", params.delay.max_change);
  add("split_size_mb", params.split_size_mb);
  add("split_duration", params.split_duration);
  add("min_free_mb", params.min_free_mb);
  add("queue_size", params.queue_size);
  add("subscriber_queue", params.subscriber_queue);
  out << YAML::EndMap;
  return std::string(out.c_str()) + "\n";
}

}  // namespace raven_correction
