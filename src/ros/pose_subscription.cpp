// SPDX-License-Identifier: BSD-3-Clause
#include "raven_correction/ros/pose_subscription.h"

#include <geometry_msgs/TransformStamped.h>
#include <ros/transport_hints.h>

#include <boost/make_shared.hpp>

#include "raven_correction/error.h"
#include "raven_correction/ros/conversions.h"
#include "raven_correction/ros/pose_command.h"

namespace raven_correction {

const std::vector<std::string>& poseTypes() {
  static const std::vector<std::string> types{"PoseStamped", "TransformStamped"};
  return types;
}

ros::Subscriber subscribePose(ros::NodeHandle& nh, const std::string& topic,
                              const std::string& type, std::uint32_t queue_size,
                              PoseCallback callback, const std::string& arm) {
  const ros::TransportHints hints = ros::TransportHints().tcpNoDelay();
  if (type == "PoseStamped")
    return nh.subscribe<geometry_msgs::PoseStamped>(topic, queue_size, callback,
                                                    ros::VoidConstPtr(), hints);
  if (type == "RavenCommand")
    return nh.subscribe<RavenCommand>(
        topic, queue_size,
        [callback = std::move(callback),
         arms = std::vector<std::string>{arm}](const boost::shared_ptr<RavenCommand const>& bytes) {
          CommandRequest command;
          if (!readCommand(*bytes, arms, command)) return;
          const ArmRequest& request = command.arms[0];
          if (request.kind != ArmRequest::Kind::kPose || !request.position || !request.orientation)
            return;
          auto pose = boost::make_shared<geometry_msgs::PoseStamped>();
          pose->header.stamp = command.stamp;
          pose->header.frame_id = std::string(command.frame);
          pose->pose = poseToMsg(request.pose);
          callback(pose);
        },
        ros::VoidConstPtr(), hints);
  if (type != "TransformStamped")
    throw InvalidInput(
        format("%s: \"%s\" is not a type of poses; use PoseStamped, TransformStamped, or "
               "RavenCommand for commands",
               topic.c_str(), type.c_str()));
  return nh.subscribe<geometry_msgs::TransformStamped>(
      topic, queue_size,
      [callback = std::move(callback)](const geometry_msgs::TransformStampedConstPtr& transform) {
        auto pose = boost::make_shared<geometry_msgs::PoseStamped>();
        pose->header = transform->header;
        pose->pose = poseToMsg(poseFromMsg(transform->transform));
        callback(pose);
      },
      ros::VoidConstPtr(), hints);
}

}  // namespace raven_correction
