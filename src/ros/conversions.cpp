// SPDX-License-Identifier: BSD-3-Clause
#include "raven_correction/ros/conversions.h"

#include <cmath>

namespace raven_correction {

Pose poseFromMsg(const geometry_msgs::Pose& msg) noexcept {
  return {{msg.position.x, msg.position.y, msg.position.z},
          {msg.orientation.w, msg.orientation.x, msg.orientation.y, msg.orientation.z}};
}

Pose poseFromMsg(const geometry_msgs::Transform& msg) noexcept {
  return {{msg.translation.x, msg.translation.y, msg.translation.z},
          {msg.rotation.w, msg.rotation.x, msg.rotation.y, msg.rotation.z}};
}

geometry_msgs::Vector3 vectorToMsg(const Eigen::Vector3d& v) noexcept {
  geometry_msgs::Vector3 msg;
  msg.x = v.x();
  msg.y = v.y();
  msg.z = v.z();
  return msg;
}

Eigen::Vector3d vectorFromMsg(const geometry_msgs::Vector3& msg) noexcept {
  return {msg.x, msg.y, msg.z};
}

geometry_msgs::Point pointToMsg(const Eigen::Vector3d& p) noexcept {
  geometry_msgs::Point msg;
  msg.x = p.x();
  msg.y = p.y();
  msg.z = p.z();
  return msg;
}

namespace {
geometry_msgs::Quaternion quaternionToMsg(const Eigen::Quaterniond& q) noexcept {
  geometry_msgs::Quaternion msg;
  msg.x = q.x();
  msg.y = q.y();
  msg.z = q.z();
  msg.w = q.w();
  return msg;
}
}  // namespace

geometry_msgs::Pose poseToMsg(const Pose& pose) noexcept {
  geometry_msgs::Pose msg;
  msg.position = pointToMsg(pose.p);
  msg.orientation = quaternionToMsg(pose.q);
  return msg;
}

geometry_msgs::Transform transformToMsg(const Pose& pose) noexcept {
  geometry_msgs::Transform msg;
  msg.translation = vectorToMsg(pose.p);
  msg.rotation = quaternionToMsg(pose.q);
  return msg;
}

StampedPose stampedPoseFromMsg(const geometry_msgs::PoseStamped& msg) noexcept {
  return {msg.header.stamp.toSec(), poseFromMsg(msg.pose)};
}

namespace {
ros::Time stampToMsg(double stamp) {
  return std::isfinite(stamp) && stamp > 0.0 ? ros::Time(stamp) : ros::Time();
}
}  // namespace

geometry_msgs::PoseStamped stampedPoseToMsg(double stamp, const Pose& pose,
                                            const std::string& frame) {
  geometry_msgs::PoseStamped msg;
  msg.header.stamp = stampToMsg(stamp);
  msg.header.frame_id = frame;
  msg.pose = poseToMsg(pose);
  return msg;
}

sensor_msgs::JointState jointsToMsg(double stamp, const std::vector<std::string>& names,
                                    const Eigen::VectorXd& positions) {
  sensor_msgs::JointState msg;
  msg.header.stamp = stampToMsg(stamp);
  msg.name = names;
  msg.position.assign(positions.data(), positions.data() + positions.size());
  return msg;
}

}  // namespace raven_correction
