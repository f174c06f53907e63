// SPDX-License-Identifier: BSD-3-Clause
// Does the node record all that is published, at the rates of a real robot, and pair it live?
#include "raven_correction/ros/recorder.h"

#include <geometry_msgs/TransformStamped.h>
#include <gtest/gtest.h>
#include <ros/ros.h>
#include <sensor_msgs/JointState.h>
#include <std_msgs/String.h>
#include <tf2_ros/static_transform_broadcaster.h>
#include <yaml-cpp/yaml.h>

#include <cmath>
#include <filesystem>
#include <thread>

#include "raven_correction/Pair.h"
#include "raven_correction/TrajectoryEvent.h"
#include "raven_correction/error.h"
#include "raven_correction/ros/conversions.h"
#include "support/node_main.h"
#include "support/recorder_probe.h"
#include "support/spin_until.h"

namespace raven_correction {
namespace {

Pose screw(double t) {  // never the identity, which is no command
  const Eigen::Vector3d v(0.05, -0.02, 0.01), w(0.3, 0.5, -0.2);
  return {Eigen::Vector3d(0.1, 0.0, 0.0) + v * t, expRotation(w * t)};
}

const Pose X_base_mocap{{0.087, 1.778, -0.770}, expRotation({0.1, -0.4, 1.2})};

using Arm = RecorderProbe;

TEST(RecorderNode, StartsAndStopsAsTheServicesSay) {
  Arm arm("/raven/left");
  EXPECT_EQ(arm.status().state, RecorderStatus::IDLE);
  const auto nothing = arm.stop();
  EXPECT_FALSE(nothing.success);
  EXPECT_NE(nothing.message.find("~start"), std::string::npos);

  const auto started = arm.start("first");
  ASSERT_TRUE(started.success) << started.message;
  EXPECT_TRUE(std::filesystem::exists(started.bag + ".active"));
  EXPECT_TRUE(arm.until([&] { return arm.status().state == RecorderStatus::RECORDING; }));
  const auto again = arm.start("second");
  EXPECT_FALSE(again.success);
  EXPECT_EQ(again.bag, started.bag);

  const auto stopped = arm.stop();
  EXPECT_TRUE(stopped.success) << stopped.message;
  EXPECT_EQ(stopped.bags, std::vector<std::string>{started.bag});
  EXPECT_TRUE(arm.until([&] { return arm.status().state == RecorderStatus::IDLE; }));
  const auto existing = arm.start("first.bag");
  EXPECT_FALSE(existing.success);
  EXPECT_NE(existing.message.find("not overwritten"), std::string::npos) << existing.message;
}

TEST(RecorderNode, RecordsAllOfAKilohertzAndPairsEveryObservation) {
  constexpr int kCommands = 3000, kSeen = 1440;  // 3 s at 1 kHz and at 480 Hz
  Arm arm("/raven/left");
  geometry_msgs::TransformStamped registration;
  registration.header.stamp = ros::Time::now();
  registration.header.frame_id = "0_link";
  registration.child_frame_id = "mocap";
  registration.transform = transformToMsg(X_base_mocap);
  tf2_ros::StaticTransformBroadcaster broadcaster;
  broadcaster.sendTransform(registration);

  auto command = arm.advertise<geometry_msgs::PoseStamped>("servo_cp");
  auto desired = arm.advertise<geometry_msgs::PoseStamped>("desired/servo_cp");
  auto seen = arm.advertise<geometry_msgs::PoseStamped>("mocap/measured_cp");
  std::vector<ros::Publisher> joints;
  const std::vector<std::string> joint_topics{"measured_js", "jaw/servo_jp", "jaw/measured_js"};
  for (const std::string& topic : joint_topics)
    joints.push_back(arm.advertise<sensor_msgs::JointState>(topic));
  auto events = arm.advertise<TrajectoryEvent>("trajectory_event");
  std::vector<Pair> live;
  const auto pairs = arm.nh.subscribe<Pair>(
      "pairs", 100000, [&](const PairConstPtr& pair) { live.push_back(*pair); });
  ASSERT_TRUE(arm.until([&] { return pairs.getNumPublishers() > 0; }));
  const auto started = arm.start("session");
  ASSERT_TRUE(started.success) << started.message;

  // The recorder must know the registration before the first pose that needs it: poses that come
  // earlier are recorded, but not paired.
  const double start = ros::Time::now().toSec();
  const Pose far = X_base_mocap.inverse() * screw(-1.0);
  int probes = 0;
  const auto registered = [&] {
    seen.publish(stampedPoseToMsg(start - 1.0 + 1e-3 * probes++, far, "mocap"));
    return arm.received("mocap/measured_cp") > 0 &&
           arm.status().message.find("tf does not know") == std::string::npos;
  };
  ASSERT_TRUE(arm.until(registered)) << arm.status().message;

  TrajectoryEvent event;
  event.header.stamp.fromSec(start);
  event.trajectory = "t001";
  event.event = TrajectoryEvent::START;
  events.publish(event);
  ASSERT_TRUE(arm.untilReceived("trajectory_event", 1));
  const auto begin = std::chrono::steady_clock::now();
  for (int k = 0, j = 0; k <= kCommands; ++k) {
    const double t = 1e-3 * k;
    command.publish(stampedPoseToMsg(start + t, screw(t), "0_link"));
    if (k % 20 == 0) desired.publish(stampedPoseToMsg(start + t, screw(t), "0_link"));
    for (const ros::Publisher& publisher : joints)
      if (k % 10 == 0) publisher.publish(sensor_msgs::JointState());
    for (; j < kSeen && j / 480.0 <= t; ++j)
      seen.publish(
          stampedPoseToMsg(start + j / 480.0, X_base_mocap.inverse() * screw(j / 480.0), "mocap"));
    ros::spinOnce();
    std::this_thread::sleep_until(begin + std::chrono::milliseconds(k));
  }
  event.header.stamp.fromSec(start + 3.0);
  event.event = TrajectoryEvent::END;
  events.publish(event);
  EXPECT_TRUE(arm.untilReceived("servo_cp", kCommands + 1));
  EXPECT_TRUE(arm.untilReceived("mocap/measured_cp", kSeen + static_cast<unsigned>(probes)));
  EXPECT_TRUE(arm.untilReceived("trajectory_event", 2));
  for (const std::string& topic : joint_topics) EXPECT_TRUE(arm.untilReceived(topic, 301));
  EXPECT_TRUE(arm.until([&] { return live.size() >= kSeen; }));

  const auto stopped = arm.stop();
  ASSERT_TRUE(stopped.success) << stopped.message;
  EXPECT_EQ(stopped.pairs, static_cast<std::uint64_t>(kSeen));
  EXPECT_EQ(stopped.trajectories, 1u);
  EXPECT_EQ(arm.status().dropped, 0u);

  using geometry_msgs::PoseStamped;
  EXPECT_EQ(read<PoseStamped>(stopped.bags, "servo_cp").size(), kCommands + 1u);
  EXPECT_EQ(read<PoseStamped>(stopped.bags, "desired/servo_cp").size(), 151u);
  EXPECT_EQ(read<PoseStamped>(stopped.bags, "mocap/measured_cp").size(),
            kSeen + static_cast<std::size_t>(probes));
  for (const std::string& topic : joint_topics)
    EXPECT_EQ(read<sensor_msgs::JointState>(stopped.bags, topic).size(), 301u) << topic;
  EXPECT_EQ(read<TrajectoryEvent>(stopped.bags, "trajectory_event").size(), 2u);
  const auto pairs_in_bag = read<Pair>(stopped.bags, "pairs");
  ASSERT_EQ(pairs_in_bag.size(), static_cast<std::size_t>(kSeen));
  for (const auto& pair : pairs_in_bag) {
    EXPECT_EQ(pair->header.frame_id, "0_link");
    EXPECT_EQ(pair->trajectory, "t001");
    const Pose sent = poseFromMsg(pair->command), observed = poseFromMsg(pair->observation);
    // The motion is exact for the interpolation; stamps are rounded to 0.24 us twice, at 0.06 m/s
    // and 0.7 rad/s.
    EXPECT_LT((sent.p - observed.p).norm(), 1e-7);
    EXPECT_LT(rotationAngle(sent.q, observed.q), 1e-6);
  }
  const auto transforms = read<tf2_msgs::TFMessage>(stopped.bags, "/tf_static");
  ASSERT_FALSE(transforms.empty());
  ASSERT_EQ(transforms.back()->transforms.size(), 1u);
  EXPECT_EQ(transforms.back()->transforms[0].header.frame_id, "0_link");
  EXPECT_EQ(transforms.back()->transforms[0].child_frame_id, "mocap");
  const auto parameters = read<std_msgs::String>(stopped.bags, "recorder/parameters");
  ASSERT_EQ(parameters.size(), 1u);
  const YAML::Node yaml = YAML::Load(parameters[0]->data);
  EXPECT_EQ(yaml["base_frame"].as<std::string>(), "0_link");
  EXPECT_FALSE(yaml["version"].as<std::string>().empty());
}

TEST(RecorderNode, KeepsRecordingWhatItCannotRegisterAndSaysSo) {
  Arm arm("/raven/left");
  auto seen = arm.advertise<geometry_msgs::PoseStamped>("mocap/measured_cp");
  ASSERT_TRUE(arm.start("").success);
  const double now = ros::Time::now().toSec();
  for (int i = 0; i < 10; ++i)
    seen.publish(stampedPoseToMsg(now + 0.01 * i, screw(0.01 * i), "somewhere"));
  ASSERT_TRUE(arm.untilReceived("mocap/measured_cp", 10));
  const auto told = [&] {
    return arm.status().message.find("static_transform_publisher") != std::string::npos;
  };
  EXPECT_TRUE(arm.until(told)) << arm.status().message;
  const auto stopped = arm.stop();
  EXPECT_TRUE(stopped.success);
  EXPECT_EQ(stopped.pairs, 0u);
  EXPECT_EQ(read<geometry_msgs::PoseStamped>(stopped.bags, "mocap/measured_cp").size(), 10u);
}

TEST(RecorderNode, SaysWhichStreamIsMissingAndWhatIsThereInstead) {
  Arm arm("/raven/left");
  const ros::Publisher other = arm.nh.advertise<geometry_msgs::PoseStamped>("tracker/pose", 10);
  const auto said = [&](const std::string& text) {
    return arm.until([&] {
      for (const std::string& finding : arm.status().findings)
        if (finding.find(text) != std::string::npos) return true;
      return false;
    });
  };
  EXPECT_TRUE(said("/raven/left/mocap/measured_cp: missing"));
  EXPECT_TRUE(said("there is /raven/left/tracker/pose [geometry_msgs/PoseStamped]"));
  // Published in another type is as good as missing.
  const ros::Publisher wrong =
      arm.nh.advertise<geometry_msgs::TransformStamped>("mocap/measured_cp", 10);
  EXPECT_TRUE(
      said("/raven/left/mocap/measured_cp: type: it is published as "
           "geometry_msgs/TransformStamped"));
}

TEST(RecorderNode, SaysThatPosesAreInMillimetres) {
  Arm arm("/raven/left");
  auto seen = arm.advertise<geometry_msgs::PoseStamped>("mocap/measured_cp");
  EXPECT_TRUE(arm.until([&] {
    Pose pose = screw(0.0);
    pose.p *= 1e3;
    seen.publish(stampedPoseToMsg(ros::Time::now().toSec(), pose, "0_link"));
    for (const std::string& finding : arm.status().findings)
      if (finding.find("millimetres") != std::string::npos) return true;
    return false;
  }));
}

TEST(RecorderNode, ConvertsTheMessagesOfTheRavenBranch) {
  Arm arm("/raven/right");
  EXPECT_TRUE(arm.until([&] { return arm.status().state == RecorderStatus::RECORDING; }));
  auto command = arm.advertise<geometry_msgs::TransformStamped>("servo_cp");
  auto seen = arm.advertise<geometry_msgs::PoseStamped>("mocap/measured_cp");
  geometry_msgs::TransformStamped message;  // no frame: as the Raven sends it
  message.header.stamp = ros::Time::now();
  message.transform = transformToMsg(screw(1.0));
  command.publish(message);
  seen.publish(stampedPoseToMsg(0.0, screw(1.0), ""));  // neither stamp nor frame
  ASSERT_TRUE(arm.untilReceived("servo_cp", 1));
  ASSERT_TRUE(arm.untilReceived("mocap/measured_cp", 1));
  const auto stopped = arm.stop();
  ASSERT_TRUE(stopped.success) << stopped.message;
  ASSERT_EQ(stopped.bags.size(), 1u);
  EXPECT_NE(stopped.bags[0].find("_0.bag"), std::string::npos);
  const auto commands = read<geometry_msgs::PoseStamped>(stopped.bags, "servo_cp");
  ASSERT_EQ(commands.size(), 1u);
  EXPECT_EQ(commands[0]->header.frame_id, "0_link");
  EXPECT_EQ(commands[0]->header.stamp, message.header.stamp);
  EXPECT_EQ(commands[0]->pose.position.x, message.transform.translation.x);
  const auto observed = read<geometry_msgs::PoseStamped>(stopped.bags, "mocap/measured_cp");
  ASSERT_EQ(observed.size(), 1u);
  EXPECT_EQ(observed[0]->header.frame_id, "0_link");
  EXPECT_GT(observed[0]->header.stamp.toSec(), 1e9);
}

TEST(RecorderParameters, AreThoseOfTheShippedFile) {
  const RecorderParams shipped = loadRecorderParams(ros::NodeHandle("/shipped"));
  const RecorderParams defaults = loadRecorderParams(ros::NodeHandle("/empty"));
  EXPECT_EQ(recorderParametersYaml(shipped), recorderParametersYaml(defaults));
}

TEST(RecorderParameters, AreRefusedTogetherWithTheirRemedy) {
  ros::NodeHandle nh("/bad");
  nh.setParam("pose_type", "Pose");
  nh.setParam("max_gap", -1.0);
  nh.setParam("split_duratoin", 10.0);
  try {
    loadRecorderParams(nh);
    FAIL() << "not refused";
  } catch (const InvalidInput& e) {
    const std::string text = e.what();
    EXPECT_NE(text.find("3 problems"), std::string::npos) << text;
    EXPECT_NE(text.find("did you mean split_duration"), std::string::npos) << text;
  }
}

}  // namespace
}  // namespace raven_correction

int main(int argc, char** argv) {
  return raven_correction::runNodeTests(argc, argv, "test_recorder");
}
