// SPDX-License-Identifier: BSD-3-Clause
// When the clock jumps back, does the recorder forget what waited, say so, and still write a bag
// that can be learned from?
#include <gtest/gtest.h>
#include <ros/ros.h>
#include <rosgraph_msgs/Clock.h>

#include "raven_correction/Pair.h"
#include "raven_correction/RecorderStatus.h"
#include "raven_correction/StartRecording.h"
#include "raven_correction/StopRecording.h"
#include "raven_correction/ros/conversions.h"
#include "raven_correction/ros/session_bag.h"
#include "support/node_main.h"
#include "support/wait_for.h"

namespace raven_correction {
namespace {

class RecorderClock : public ::testing::Test {
 protected:
  RecorderClock() {
    status_subscriber_ =
        nh_.subscribe<RecorderStatus>("recorder/status", 10, [this](const auto& message) {
          status_ = *message;
          said_ += message->message + "\n";
        });
    pair_subscriber_ = nh_.subscribe<Pair>(
        "pairs", 100, [this](const auto& pair) { pairs_.push_back(pair->header.stamp.toSec()); });
    clock_ = nh_.advertise<rosgraph_msgs::Clock>("/clock", 100);
    command_ = nh_.advertise<geometry_msgs::PoseStamped>("servo_cp", 100);
    seen_ = nh_.advertise<geometry_msgs::PoseStamped>("mocap/measured_cp", 100);
  }

  /// Waits for a condition while the clock stands at `time`.
  template <typename Condition>
  bool until(double time, Condition condition) {
    rosgraph_msgs::Clock now;
    now.clock.fromSec(time);
    return waitFor(
        [&] {
          clock_.publish(now);
          ros::spinOnce();
          return condition();
        },
        15.0);
  }

  /// The recorder hears the clock, too: what has not been known cannot jump.
  bool connected(double time) {
    return until(time, [&] {
      return command_.getNumSubscribers() > 0 && seen_.getNumSubscribers() > 0 &&
             pair_subscriber_.getNumPublishers() > 0 && status_.header.stamp.toSec() == time;
    });
  }

  bool received(double time, std::uint64_t commands) {
    return until(time,
                 [&] { return !status_.messages.empty() && status_.messages[0] >= commands; });
  }

  static geometry_msgs::PoseStamped pose(double stamp) {
    return stampedPoseToMsg(stamp, {{0.1, 0.0, 0.001 * stamp}, expRotation({0.1, 0.0, 0.0})},
                            "0_link");
  }

  ros::NodeHandle nh_{"/arm"};
  ros::Publisher clock_, command_, seen_;
  RecorderStatus status_;
  std::string said_;  // every message of the status
  std::vector<double> pairs_;

 private:
  ros::Subscriber status_subscriber_, pair_subscriber_;
};

TEST_F(RecorderClock, ForgetsWhatWaitedWhenTheClockJumpsBackAndSaysSo) {
  ASSERT_TRUE(connected(50.0));
  command_.publish(pose(50.0));
  command_.publish(pose(50.2));
  seen_.publish(pose(50.1));
  ASSERT_TRUE(until(50.0, [&] { return pairs_.size() == 1; }));
  ASSERT_TRUE(until(40.0, [&] { return said_.find("back by 10.000 s") != std::string::npos; }))
      << said_;

  // Within the horizon of 60 s: without the jump of the clock these would be late and repeated.
  seen_.publish(pose(40.1));
  command_.publish(pose(40.0));
  command_.publish(pose(40.2));
  EXPECT_TRUE(until(40.0, [&] { return pairs_.size() == 2; }));
  ASSERT_EQ(pairs_.size(), 2u);
  EXPECT_NEAR(pairs_[1], 40.1, 1e-9);
}

TEST_F(RecorderClock, LeavesOutOfTheBagWhatGoesBackSaysSoAndTheBagCanBeRead) {
  ASSERT_TRUE(connected(100.0));
  StartRecording start;
  ASSERT_TRUE(ros::service::call(nh_.resolveName("recorder/start"), start));
  ASSERT_TRUE(start.response.success) << start.response.message;
  const auto visit = [&](double from) {
    for (int i = 0; i < 10; ++i) {
      command_.publish(pose(from + 0.1 * i));
      seen_.publish(pose(from + 0.1 * i));
    }
  };
  visit(100.0);
  ASSERT_TRUE(received(101.0, 10));
  visit(90.0);  // a bag that is played in a loop
  ASSERT_TRUE(received(90.0, 20));
  visit(101.0);
  ASSERT_TRUE(received(102.0, 30));
  EXPECT_TRUE(until(102.0, [&] { return status_.out_of_order == 20; })) << status_.out_of_order;
  EXPECT_NE(said_.find("servo_cp: the stamp 90.000000 lies 10.900000 s before"), std::string::npos)
      << said_;

  StopRecording stop;
  ASSERT_TRUE(ros::service::call(nh_.resolveName("recorder/stop"), stop));
  ASSERT_TRUE(stop.response.success) << stop.response.message;
  EXPECT_NE(stop.response.message.find("20 messages were left out"), std::string::npos)
      << stop.response.message;
  const Dataset session = readInputs(stop.response.bags);
  ASSERT_EQ(session.trajectories.size(), 1u);
  EXPECT_EQ(session.trajectories[0].commands.size(), 20u);
  EXPECT_EQ(session.trajectories[0].observations.size(), 20u);
  EXPECT_EQ(session.trajectories[0].commands.back().stamp, 101.9);
}

}  // namespace
}  // namespace raven_correction

int main(int argc, char** argv) {
  return raven_correction::runNodeTests(argc, argv, "test_recorder_clock");
}
