// SPDX-License-Identifier: BSD-3-Clause
// When the clock jumps back, does the recorder forget what waited, and say so?
#include <gtest/gtest.h>
#include <ros/ros.h>
#include <rosgraph_msgs/Clock.h>

#include "raven_correction/Pair.h"
#include "raven_correction/RecorderStatus.h"
#include "raven_correction/ros/conversions.h"
#include "support/wait_for.h"

namespace raven_correction {
namespace {

TEST(RecorderClock, ForgetsWhatWaitedWhenTheClockJumpsBackAndSaysSo) {
  ros::NodeHandle nh("/arm");
  std::string message;
  bool said_so = false;
  std::vector<double> pairs;
  const auto status =
      nh.subscribe<RecorderStatus>("recorder/status", 10, [&](const RecorderStatusConstPtr& s) {
        message = s->message;
        said_so = said_so || message.find("jumped back by 10.000 s") != std::string::npos;
      });
  const auto pair_subscriber = nh.subscribe<Pair>(
      "pairs", 100, [&](const PairConstPtr& pair) { pairs.push_back(pair->header.stamp.toSec()); });
  auto clock = nh.advertise<rosgraph_msgs::Clock>("/clock", 100);
  auto command = nh.advertise<geometry_msgs::PoseStamped>("servo_cp", 100);
  auto seen = nh.advertise<geometry_msgs::PoseStamped>("mocap/measured_cp", 100);
  const auto until = [&](double time, const auto& condition) {
    rosgraph_msgs::Clock now;
    now.clock.fromSec(time);
    return waitFor(
        [&] {
          clock.publish(now);
          ros::spinOnce();
          return condition();
        },
        15.0);
  };
  const auto pose = [](double stamp) {
    return stampedPoseToMsg(stamp, {{0.1, 0.0, 0.001 * stamp}, expRotation({0.1, 0.0, 0.0})},
                            "0_link");
  };
  ASSERT_TRUE(until(50.0, [&] {
    return command.getNumSubscribers() > 0 && seen.getNumSubscribers() > 0 &&
           pair_subscriber.getNumPublishers() > 0 && message == "idle";
  }));
  command.publish(pose(50.0));
  command.publish(pose(50.2));
  seen.publish(pose(50.1));
  ASSERT_TRUE(until(50.0, [&] { return pairs.size() == 1; }));
  // The next status, which may arrive in the same moment, speaks of something else again.
  ASSERT_TRUE(until(40.0, [&] { return said_so; })) << message;

  // Within the horizon of 60 s: without the jump of the clock these would be late and repeated.
  seen.publish(pose(40.1));
  command.publish(pose(40.0));
  command.publish(pose(40.2));
  EXPECT_TRUE(until(40.0, [&] { return pairs.size() == 2; }));
  ASSERT_EQ(pairs.size(), 2u);
  EXPECT_NEAR(pairs[1], 40.1, 1e-9);
}

}  // namespace
}  // namespace raven_correction

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  ros::init(argc, argv, "test_recorder_clock");
  const ros::NodeHandle nh;
  return RUN_ALL_TESTS();
}
