// SPDX-License-Identifier: BSD-3-Clause
// Where other frames stand in the base frame, as tf knows it now (mocap in base above all), and the
// static transforms that a bag must hold so that this can be looked up again.
#pragma once

#include <geometry_msgs/TransformStamped.h>
#include <tf2_msgs/TFMessage.h>
#include <tf2_ros/buffer.h>
#include <tf2_ros/transform_listener.h>

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "raven_correction/geometry/pose.h"

namespace raven_correction {

/// Looks frames up in tf without ever waiting; for use in callbacks.
class Registration {
 public:
  explicit Registration(const std::string& base_frame);

  const std::string& baseFrame() const { return base_frame_; }
  /// X_base_frame, the latest that tf has; identity for the base frame itself; nothing while tf
  /// does not connect the two, or for an empty name.
  std::optional<Pose> find(const std::string& frame) const;
  void clear() { buffer_.clear(); }  ///< static transforms included

 private:
  std::string base_frame_;
  tf2_ros::Buffer buffer_;
  tf2_ros::TransformListener listener_;
};

/// The latest static transform of each child frame, for the bag.
class StaticTransforms {
 public:
  void add(const tf2_msgs::TFMessage& message);
  /// States X_base_frame directly, in the place of the chain that led to it, so that readers need
  /// no tf. What would make two parents or a loop is left out.
  /// @return false if this is known already
  bool setRegistration(const std::string& base_frame, const std::string& frame,
                       const Pose& X_base_frame, const ros::Time& stamp);
  tf2_msgs::TFMessage message() const;
  bool empty() const { return by_child_.empty() && registrations_.empty(); }

 private:
  bool isBelow(std::string frame, const std::string& ancestor) const;

  std::map<std::string, geometry_msgs::TransformStamped> by_child_;
  std::map<std::string, geometry_msgs::TransformStamped> registrations_;  // by child
};

}  // namespace raven_correction
