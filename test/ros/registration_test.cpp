// SPDX-License-Identifier: BSD-3-Clause
// Do the static transforms of a bag form a tree that states the registration directly?
#include "raven_correction/ros/registration.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "raven_correction/ros/conversions.h"

namespace raven_correction {
namespace {

geometry_msgs::TransformStamped edge(const std::string& parent, const std::string& child,
                                     double x = 0.0) {
  geometry_msgs::TransformStamped transform;
  transform.header.frame_id = parent;
  transform.child_frame_id = child;
  transform.transform = transformToMsg(Pose{{x, 0.0, 0.0}, Eigen::Quaterniond::Identity()});
  return transform;
}

tf2_msgs::TFMessage edges(std::vector<geometry_msgs::TransformStamped> list) {
  tf2_msgs::TFMessage message;
  message.transforms = std::move(list);
  return message;
}

std::vector<std::string> names(const tf2_msgs::TFMessage& message) {
  std::vector<std::string> list;
  for (const auto& t : message.transforms)
    list.push_back(t.header.frame_id + ">" + t.child_frame_id);
  std::sort(list.begin(), list.end());
  return list;
}

const Pose kSome{{1.0, 2.0, 3.0}, Eigen::Quaterniond::Identity()};
using Names = std::vector<std::string>;

TEST(StaticTransforms, KeepTheLatestOfEachChild) {
  StaticTransforms transforms;
  transforms.add(edges({edge("0_link", "mocap", 1.0), edge("world", "0_link")}));
  transforms.add(edges({edge("0_link", "mocap", 2.0)}));
  const tf2_msgs::TFMessage message = transforms.message();
  EXPECT_EQ(names(message), (Names{"0_link>mocap", "world>0_link"}));
  for (const auto& t : message.transforms) {
    EXPECT_EQ(t.transform.translation.x, t.child_frame_id == "mocap" ? 2.0 : 0.0);
  }
}

TEST(StaticTransforms, ReplaceASiblingChainByTheRegistration) {
  StaticTransforms transforms;
  transforms.add(edges({edge("world", "0_link"), edge("world", "mocap")}));
  EXPECT_TRUE(transforms.setRegistration("0_link", "mocap", kSome, ros::Time(5)));
  EXPECT_EQ(names(transforms.message()), (Names{"0_link>mocap", "world>0_link"}));
}

TEST(StaticTransforms, BreakTheLoopWhenTheBaseHangsBelowMocap) {
  StaticTransforms transforms;
  transforms.add(edges({edge("mocap", "table"), edge("table", "/0_link"), edge("0_link", "tool")}));
  transforms.setRegistration("0_link", "mocap", kSome, ros::Time(5));
  EXPECT_EQ(names(transforms.message()), (Names{"0_link>mocap", "0_link>tool", "mocap>table"}));
}

TEST(StaticTransforms, TellAKnownRegistrationFromANewOne) {
  StaticTransforms transforms;
  EXPECT_TRUE(transforms.setRegistration("0_link", "mocap", kSome, ros::Time(5)));
  EXPECT_FALSE(transforms.setRegistration("0_link", "mocap", kSome, ros::Time(6)));
  EXPECT_TRUE(transforms.setRegistration("0_link", "mocap", Pose{}, ros::Time(7)));
  ASSERT_EQ(transforms.message().transforms.size(), 1u);
  EXPECT_EQ(transforms.message().transforms[0].header.stamp, ros::Time(7));
}

}  // namespace
}  // namespace raven_correction
