// SPDX-License-Identifier: BSD-3-Clause
// Subscribes to poses whose message type differs between robot stacks (design, section 4), and
// hands all of them on as PoseStamped.
#pragma once

#include <geometry_msgs/PoseStamped.h>
#include <ros/node_handle.h>
#include <ros/subscriber.h>

#include <functional>
#include <string>
#include <vector>

namespace raven_correction {

/// "PoseStamped" (CRTK since 2022) and "TransformStamped" (Raven II CRTK branch, Vicon).
const std::vector<std::string>& poseTypes();

using PoseCallback = std::function<void(const geometry_msgs::PoseStampedConstPtr&)>;

/// @param topic       relative name
/// @param type        one of poseTypes()
/// @param queue_size  messages that wait for the callback [1]
/// @param arm  for the type "RavenCommand": the arm whose absolute poses are handed on; commands
///             that ask nothing or an increment of it are not
/// @throws InvalidInput  unknown type
ros::Subscriber subscribePose(ros::NodeHandle& nh, const std::string& topic,
                              const std::string& type, std::uint32_t queue_size,
                              PoseCallback callback, const std::string& arm = "");

}  // namespace raven_correction
