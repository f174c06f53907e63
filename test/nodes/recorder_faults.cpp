// SPDX-License-Identifier: BSD-3-Clause
// Faults of doc/faults.md that reach a recorder through its topics: bursts, publishers that go and
// come back, two arms at once, a clock that is off. Those of clocks that jump are
// recorder_clock.cpp, those of disks and processes recorder_processes.py.
#include <diagnostic_msgs/DiagnosticArray.h>
#include <geometry_msgs/PoseStamped.h>
#include <gtest/gtest.h>
#include <ros/ros.h>

#include <cmath>
#include <thread>

#include "raven_correction/CorrectionModel.h"
#include "raven_correction/Pair.h"
#include "raven_correction/ros/conversions.h"
#include "raven_correction/ros/session_bag.h"
#include "support/node_main.h"
#include "support/recorder_probe.h"

namespace raven_correction {
namespace {

using geometry_msgs::PoseStamped;

/// Back and forth along all axes, never the identity; about 0.1 m/s.
Pose motion(double t) {
  return {{0.1 + 0.05 * std::sin(2.0 * t), 0.05 * std::cos(1.3 * t), 0.02 * std::sin(0.7 * t)},
          expRotation({0.1 * std::sin(t), 0.0, 0.05})};
}

/// Waits for diagnostics of a recorder that come after this call and satisfy the condition.
template <typename Condition>
bool diagnosed(RecorderProbe& arm, Condition condition) {
  bool found = false;
  const ros::Subscriber subscriber = arm.nh.subscribe<diagnostic_msgs::DiagnosticArray>(
      "/diagnostics", 100, [&](const auto& message) {
        for (const auto& status : message->status)
          if (status.name.find(arm.nh.resolveName("recorder").substr(1)) != std::string::npos)
            found |= condition(status);
      });
  return arm.until([&] { return found; });
}

TEST(RecorderFaults, BurstIsInTheBagMessageByMessage) {
  RecorderProbe arm("/left");
  ros::Publisher command = arm.advertise<PoseStamped>("servo_cp");
  ros::Publisher seen = arm.advertise<PoseStamped>("mocap/measured_cp");
  ASSERT_TRUE(arm.start("burst").success);
  // All at once: as many as may wait on a topic of the node, less some.
  constexpr unsigned kBurst = 15000;
  const double start = ros::Time::now().toSec();
  const auto at = [&](unsigned i) { return start + 1e-4 * i; };
  for (unsigned i = 0; i < kBurst; ++i) {
    command.publish(stampedPoseToMsg(at(i), motion(1e-4 * i), "0_link"));
    if (i % 20 == 0) seen.publish(stampedPoseToMsg(at(i), motion(1e-4 * i), "0_link"));
  }
  EXPECT_TRUE(arm.untilReceived("servo_cp", kBurst));
  EXPECT_TRUE(arm.untilReceived("mocap/measured_cp", kBurst / 20));
  // And 10 kHz for a second.
  const auto begin = std::chrono::steady_clock::now();
  for (unsigned i = kBurst; i < kBurst + 10000; ++i) {
    command.publish(stampedPoseToMsg(at(i), motion(1e-4 * i), "0_link"));
    if (i % 10 == 0)
      std::this_thread::sleep_until(begin + std::chrono::microseconds(100) * (i - kBurst));
  }
  EXPECT_TRUE(arm.untilReceived("servo_cp", kBurst + 10000));
  const StopRecording::Response stopped = arm.stop();
  ASSERT_TRUE(stopped.success) << stopped.message;
  EXPECT_EQ(arm.status().dropped, 0u);
  EXPECT_EQ(arm.status().out_of_order, 0u);
  const auto commands = read<PoseStamped>(stopped.bags, "servo_cp");
  ASSERT_EQ(commands.size(), kBurst + 10000u);
  for (unsigned i = 0; i < commands.size(); ++i)
    ASSERT_NEAR(commands[i]->header.stamp.toSec(), at(i), 1e-6) << i;
  EXPECT_EQ(read<PoseStamped>(stopped.bags, "mocap/measured_cp").size(), kBurst / 20);
}

TEST(RecorderFaults, TopicThatGoesAndComesBackIsReportedAndGoesOnInTheSameBag) {
  RecorderProbe arm("/left");
  ros::Publisher command = arm.advertise<PoseStamped>("servo_cp");
  ros::Publisher seen = arm.advertise<PoseStamped>("mocap/measured_cp");
  ASSERT_TRUE(arm.start("gone").success);
  const double start = ros::Time::now().toSec();
  const auto both = [&](double from) {
    for (int i = 0; i <= 50; ++i) {
      const double t = from + 0.01 * i;
      command.publish(stampedPoseToMsg(start + t, motion(t), "0_link"));
      if (i < 50) seen.publish(stampedPoseToMsg(start + t + 0.005, motion(t), "0_link"));
    }
  };
  both(0.0);
  ASSERT_TRUE(arm.untilReceived("mocap/measured_cp", 50));
  seen.shutdown();  // the driver dies; commands go on
  command.publish(stampedPoseToMsg(start + 0.6, motion(0.6), "0_link"));
  const auto silent = [](const diagnostic_msgs::DiagnosticStatus& status) {
    return status.level == diagnostic_msgs::DiagnosticStatus::WARN &&
           status.message.find("mocap/measured_cp is silent") != std::string::npos;
  };
  EXPECT_TRUE(diagnosed(arm, silent));
  EXPECT_EQ(arm.status().state, RecorderStatus::RECORDING);
  command.shutdown();  // and then the planner

  seen = arm.advertise<PoseStamped>("mocap/measured_cp");
  command = arm.advertise<PoseStamped>("servo_cp");
  both(10.0);
  ASSERT_TRUE(arm.untilReceived("mocap/measured_cp", 100));
  ASSERT_TRUE(arm.untilReceived("servo_cp", 103));
  EXPECT_TRUE(diagnosed(arm, [&](const auto& status) { return !silent(status); }));
  const StopRecording::Response stopped = arm.stop();
  ASSERT_TRUE(stopped.success) << stopped.message;
  EXPECT_EQ(stopped.pairs, 100u);  // nothing is paired across the gap
  EXPECT_EQ(read<PoseStamped>(stopped.bags, "servo_cp").size(), 103u);
  const Dataset session = readInputs(stopped.bags);
  ASSERT_EQ(session.trajectories.size(), 2u);
  EXPECT_EQ(session.trajectories[1].observations.size(), 50u);
}

TEST(RecorderFaults, TwoArmsAtOnceDoNotMix) {
  RecorderProbe left("/left"), right("/right");
  std::vector<ros::Publisher> commands, seen;
  for (RecorderProbe* const arm : {&left, &right}) {
    commands.push_back(arm->advertise<PoseStamped>("servo_cp"));
    seen.push_back(arm->advertise<PoseStamped>("mocap/measured_cp"));
    ASSERT_TRUE(arm->start("both").success);
  }
  const double start = ros::Time::now().toSec();
  constexpr unsigned kCount = 1000;
  for (unsigned i = 0; i < kCount; ++i)
    for (std::size_t arm = 0; arm < 2; ++arm) {
      const Pose pose{{0.1 + static_cast<double>(arm), 1e-4 * i, 0.0},
                      expRotation({0.1, 0.0, 0.0})};
      commands[arm].publish(stampedPoseToMsg(start + 1e-3 * i, pose, "0_link"));
      if (i % 10 == 0) seen[arm].publish(stampedPoseToMsg(start + 1e-3 * i, pose, "0_link"));
    }
  for (RecorderProbe* const arm : {&left, &right}) {
    ASSERT_TRUE(arm->untilReceived("servo_cp", kCount));
    ASSERT_TRUE(arm->untilReceived("mocap/measured_cp", kCount / 10));
  }
  for (std::size_t arm = 0; arm < 2; ++arm) {
    const StopRecording::Response stopped = (arm == 0 ? left : right).stop();
    ASSERT_TRUE(stopped.success) << stopped.message;
    EXPECT_EQ(stopped.pairs, kCount / 10);
    const auto written = read<PoseStamped>(stopped.bags, "servo_cp");
    ASSERT_EQ(written.size(), kCount);
    for (const auto& message : written)
      ASSERT_EQ(message->pose.position.x, 0.1 + static_cast<double>(arm));
  }
}

TEST(RecorderFaults, ClockOfTheCamerasThatIsOffIsReportedAsAChangeOfTheDelay) {
  RecorderProbe arm("/right");
  ros::Publisher command = arm.advertise<PoseStamped>("servo_cp");
  ros::Publisher seen = arm.advertise<PoseStamped>("mocap/measured_cp");
  ros::Publisher model = arm.advertise<CorrectionModel>("correction/model");
  constexpr double kDelay = 0.12;  // of the model, and of the tool [s]
  CorrectionModel trained;
  trained.id = "trained";
  trained.delay = kDelay;
  trained.speed_delay = kDelay;
  model.publish(trained);
  // Half a minute of stamps at once: what counts are stamps.
  double start = ros::Time::now().toSec();
  const auto run = [&](double clock_error) {
    for (int i = 0; i < 3000; ++i) {
      const double t = 0.01 * i;
      command.publish(stampedPoseToMsg(start + t, motion(t), "0_link"));
      seen.publish(stampedPoseToMsg(start + t + clock_error, motion(t - kDelay), "0_link"));
    }
    start += 31.0;
  };
  const auto says = [&](double delay) {
    return [delay](const diagnostic_msgs::DiagnosticStatus& status) {
      for (const auto& value : status.values)
        if (value.key == "delay of motion capture [s]")
          return std::abs(std::stod(value.value) - delay) < 0.005;
      return false;
    };
  };
  const auto warned = [](const diagnostic_msgs::DiagnosticStatus& status) {
    return status.level == diagnostic_msgs::DiagnosticStatus::WARN &&
           status.message.find("behind the commands") != std::string::npos;
  };
  run(0.0);
  EXPECT_TRUE(
      diagnosed(arm, [&](const auto& status) { return says(kDelay)(status) && !warned(status); }));
  run(0.05);
  EXPECT_TRUE(diagnosed(
      arm, [&](const auto& status) { return says(kDelay + 0.05)(status) && warned(status); }));
  EXPECT_TRUE(arm.until([&] {
    return arm.status().message.find("in what model trained was") != std::string::npos;
  })) << arm.status().message;
  run(0.0);
  EXPECT_TRUE(
      diagnosed(arm, [&](const auto& status) { return says(kDelay)(status) && !warned(status); }));
}

}  // namespace
}  // namespace raven_correction

int main(int argc, char** argv) {
  return raven_correction::runNodeTests(argc, argv, "test_recorder_faults");
}
