// SPDX-License-Identifier: BSD-3-Clause
// Between ROS messages and the types of the core. Quaternions of messages are x,y,z,w. No checks:
// what is not finite or not of unit length passes through and is judged by the core.
#pragma once

#include <geometry_msgs/Pose.h>
#include <geometry_msgs/PoseStamped.h>
#include <geometry_msgs/Transform.h>
#include <geometry_msgs/Vector3.h>
#include <sensor_msgs/JointState.h>

#include <string>
#include <vector>

#include "raven_correction/geometry/stream.h"

namespace raven_correction {

Pose poseFromMsg(const geometry_msgs::Pose& msg) noexcept;
Pose poseFromMsg(const geometry_msgs::Transform& msg) noexcept;
geometry_msgs::Pose poseToMsg(const Pose& pose) noexcept;
geometry_msgs::Transform transformToMsg(const Pose& pose) noexcept;
geometry_msgs::Vector3 vectorToMsg(const Eigen::Vector3d& v) noexcept;
Eigen::Vector3d vectorFromMsg(const geometry_msgs::Vector3& msg) noexcept;
geometry_msgs::Point pointToMsg(const Eigen::Vector3d& p) noexcept;
StampedPose stampedPoseFromMsg(const geometry_msgs::PoseStamped& msg) noexcept;
/// @param stamp  [s]; not finite or negative becomes 0
geometry_msgs::PoseStamped stampedPoseToMsg(double stamp, const Pose& pose,
                                            const std::string& frame);
/// Positions alone.
/// @param stamp  as in stampedPoseToMsg()
/// @param names  one per position [rad or m]
sensor_msgs::JointState jointsToMsg(double stamp, const std::vector<std::string>& names,
                                    const Eigen::VectorXd& positions);

}  // namespace raven_correction
