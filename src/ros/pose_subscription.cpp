// SPDX-License-Identifier: BSD-3-Clause
#include "raven_correction/ros/pose_subscription.h"

#include <geometry_msgs/TransformStamped.h>
#include <ros/transport_hints.h>

#include <boost/make_shared.hpp>

#include "raven_correction/error.h"
#include "raven_correction/ros/conversions.h"

namespace raven_correction {

const std::vector<std::string>& poseTypes() {
  static const std::vector<std::string> types{"PoseStamped", "TransformStamped"};
  return types;
}

ros::Subscriber subscribePose(ros::NodeHandle& nh, const std::string& topic,
                              const std::string& type, std::uint32_t queue_size,
                              PoseCallback callback) {
  const ros::TransportHints hints = ros::TransportHints().tcpNoDelay();
  if (type == "PoseStamped")
    return nh.subscribe<geometry_msgs::PoseStamped>(topic, queue_size, callback,
                                                    ros::VoidConstPtr(), hints);
  if (type != "TransformStamped")
    throw InvalidInput(
        format("%s: \"%s\" is not a type of poses; use PoseStamped or "
               "TransformStamped",
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
