// SPDX-License-Identifier: BSD-3-Clause
// The corrector as a nodelet in the process of planner and controller: does it correct, and does it
// hand on what it does not change without a copy?
#include <geometry_msgs/PoseStamped.h>
#include <gtest/gtest.h>
#include <nodelet/loader.h>

#include <boost/make_shared.hpp>
#include <thread>

#include "raven_correction/ros/realtime.h"
#include "support/corrector_probe.h"
#include "support/node_main.h"
#include "support/scheduling.h"
#include "support/simple_model.h"
#include "support/wait_for.h"

namespace raven_correction {
namespace {

const Pose kInside{{0.01, 0.01, -0.01}, expRotation({0.02, 0.0, 0.01})};

TEST(CorrectorNodelet, CorrectsAndHandsOnWithoutACopy) {
  nodelet::Loader loader(/*provide_ros_api=*/false);
  ASSERT_TRUE(loader.load("/arm/corrector", "raven_correction/corrector", {}, {}));
  CorrectorProbe<geometry_msgs::PoseStamped> probe("arm");
  std::vector<geometry_msgs::PoseStamped::ConstPtr> received;
  ros::NodeHandle nh("arm");
  const ros::Subscriber subscriber = nh.subscribe<geometry_msgs::PoseStamped>(
      "servo_cp", 10, [&](const auto& message) { received.push_back(message); });
  ASSERT_TRUE(probe.until([&] { return subscriber.getNumPublishers() == 1; }));

  const auto send = [&] {
    const auto message = boost::make_shared<geometry_msgs::PoseStamped>(probe.message(kInside));
    received.clear();
    probe.publisher.publish(message);
    EXPECT_TRUE(probe.until([&] { return !received.empty(); }));
    return message;
  };
  const auto unchanged = send();
  ASSERT_FALSE(received.empty());
  EXPECT_EQ(received.front().get(), unchanged.get());  // the very message

  probe.publishModel(simpleModel());
  probe.setMode("full");
  EXPECT_TRUE(probe.sendUntil(kInside, [](const CorrectionStatus& status) {
    return status.code == CorrectionStatus::CORRECTED;
  }));
  // A second publisher in the same process is the same node to the master.
  {
    ros::Publisher second = nh.advertise<geometry_msgs::PoseStamped>("servo_cp", 1);
    EXPECT_TRUE(probe.sendUntil(kInside, [](const CorrectionStatus& status) {
      return status.code == CorrectionStatus::PASSED_OTHER_PUBLISHER;
    }));
  }
  EXPECT_TRUE(probe.sendUntil(kInside, [](const CorrectionStatus& status) {
    return status.code == CorrectionStatus::CORRECTED;
  }));
  const auto sent = send();
  ASSERT_FALSE(received.empty());
  EXPECT_NE(received.front().get(), sent.get());
  EXPECT_EQ(received.front()->header.stamp, sent->header.stamp);
  EXPECT_GT((poseFromMsg(received.front()->pose).p - kInside.p).norm(), 0.005);
  EXPECT_TRUE(loader.unload("/arm/corrector"));
}

/// Under SCHED_FIFO there are these threads, soon.
bool become(const RealtimeThreads& expected) {
  return waitFor([&] { return realtimeThreads() == expected; }, 20.0);
}

class RealtimeThreadsTest : public ::testing::Test {
 protected:
  void SetUp() override {
    std::string refusal;
    std::thread([&] { refusal = takeRealtimePriority(10); }).join();
    if (!refusal.empty()) GTEST_SKIP() << refusal;
    ASSERT_TRUE(become({}));
  }
};

TEST_F(RealtimeThreadsTest, TheNodeletTakesItForItsLiveThreadAlone) {
  nodelet::Loader loader(/*provide_ros_api=*/false);
  ASSERT_TRUE(loader.load("/realtime/corrector", "raven_correction/corrector", {}, {}));
  const RealtimeThreads live{{"corrector_live", 10}};
  EXPECT_TRUE(become(live));
  CorrectorProbe<geometry_msgs::PoseStamped> probe("realtime");
  EXPECT_TRUE(probe.sendUntil(kInside, [](const CorrectionStatus& status) {
    return status.code == CorrectionStatus::PASSED_OFF;
  }));
  EXPECT_EQ(realtimeThreads(), live);
  EXPECT_TRUE(loader.unload("/realtime/corrector"));
  EXPECT_TRUE(become({}));
}

// The last one: the thread keeps it for as long as this process runs.
TEST_F(RealtimeThreadsTest, SocketsTakeIt) {
  pthread_setname_np(pthread_self(), "asks");
  EXPECT_EQ(giveSocketsRealtimePriority(9), "");
  const RealtimeThreads threads = realtimeThreads();
  ASSERT_EQ(threads.size(), 1u);
  EXPECT_NE(threads[0].first, "asks");
  EXPECT_EQ(threads[0].second, 9);
}

}  // namespace
}  // namespace raven_correction

int main(int argc, char** argv) {
  return raven_correction::runNodeTests(argc, argv, "test_corrector_nodelet");
}
