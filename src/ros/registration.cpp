// SPDX-License-Identifier: BSD-3-Clause
#include "raven_correction/ros/registration.h"

#include <tf2/exceptions.h>

#include "raven_correction/ros/conversions.h"
#include "raven_correction/ros/names.h"

namespace raven_correction {

Registration::Registration(const std::string& base_frame)
    : base_frame_(withoutSlash(base_frame)), listener_(buffer_) {}

std::optional<Pose> Registration::find(const std::string& frame) const {
  const std::string name = withoutSlash(frame);
  if (name.empty()) return std::nullopt;
  if (name == base_frame_) return Pose{};
  try {
    const auto found = buffer_.lookupTransform(base_frame_, name, ros::Time(0), ros::Duration(0));
    return poseFromMsg(found.transform);
  } catch (const tf2::TransformException&) {
    return std::nullopt;
  }
}

void StaticTransforms::add(const tf2_msgs::TFMessage& message) {
  for (const auto& transform : message.transforms)
    by_child_[withoutSlash(transform.child_frame_id)] = transform;
}

bool StaticTransforms::setRegistration(const std::string& base_frame, const std::string& frame,
                                       const Pose& X_base_frame, const ros::Time& stamp) {
  geometry_msgs::TransformStamped transform;
  transform.header.frame_id = base_frame;
  transform.child_frame_id = frame;
  transform.transform = transformToMsg(X_base_frame);
  const auto known = registrations_.find(frame);
  if (known != registrations_.end()) {
    transform.header.stamp = known->second.header.stamp;
    if (known->second == transform) return false;
  }
  transform.header.stamp = stamp;
  registrations_[frame] = transform;
  return true;
}

bool StaticTransforms::isBelow(std::string frame, const std::string& ancestor) const {
  for (std::size_t steps = 0; steps <= by_child_.size(); ++steps) {
    const auto parent = by_child_.find(frame);
    if (parent == by_child_.end()) return false;
    frame = withoutSlash(parent->second.header.frame_id);
    if (frame == ancestor) return true;
  }
  return false;
}

tf2_msgs::TFMessage StaticTransforms::message() const {
  tf2_msgs::TFMessage message;
  for (const auto& [child, transform] : by_child_) {
    bool left_out = registrations_.count(child) > 0;          // would have two parents
    for (const auto& [frame, registration] : registrations_)  // would hang below itself
      left_out |= child == withoutSlash(registration.header.frame_id) && isBelow(child, frame);
    if (!left_out) message.transforms.push_back(transform);
  }
  for (const auto& [frame, registration] : registrations_)
    message.transforms.push_back(registration);
  return message;
}

}  // namespace raven_correction
