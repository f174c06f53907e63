// SPDX-License-Identifier: BSD-3-Clause
// Bags that a real stack leaves behind: split, without a frame, with mixed frames, with events of
// another clock. What is good comes in; what is not is refused with its place.
#include "raven_correction/ros/session_bag.h"

#include <gtest/gtest.h>
#include <raven_correction/TrajectoryEvent.h>
#include <rosbag/bag.h>
#include <std_msgs/Header.h>
#include <tf2_msgs/TFMessage.h>

#include <fstream>
#include <iterator>

#include "raven_correction/error.h"
#include "raven_correction/ros/conversions.h"
#include "raven_correction/ros/topics.h"
#include "support/temporary_directory.h"

namespace raven_correction {
namespace {

const Pose X_base_mocap{{0.1, 1.7, -0.7}, expRotation({0.1, -0.4, 1.2})};

Pose poseAtTime(double t) { return {{0.01 * t, 0.05, -0.1}, expRotation({0.0, 0.1 * t, 0.0})}; }

class SessionBag : public ::testing::Test {
 protected:
  std::string path(const std::string& name) const { return folder_.path() + "/" + name; }

  void event(rosbag::Bag& bag, double stamp, const std::string& name, std::uint8_t kind,
             const Pose* target = nullptr) const {
    TrajectoryEvent msg;
    msg.header.stamp.fromSec(stamp);
    msg.trajectory = name;
    msg.event = kind;
    if (target != nullptr) msg.target = poseToMsg(*target);
    bag.write(topics::kTrajectoryEvent, msg.header.stamp, msg);
  }

  /// Commands and observations from `from` to `to`, every 0.1 s.
  void streams(rosbag::Bag& bag, double from, double to, const std::string& base,
               const std::string& mocap) const {
    for (int i = 0; from + 0.1 * i <= to; ++i) {
      const double t = from + 0.1 * i;
      const ros::Time stamp(t);
      bag.write(topics::kCommand, stamp, stampedPoseToMsg(t, poseAtTime(t), base));
      bag.write(topics::kMocap, stamp,
                stampedPoseToMsg(t, X_base_mocap.inverse() * poseAtTime(t), mocap));
    }
  }

  void registration(rosbag::Bag& bag) const {
    tf2_msgs::TFMessage tf;
    tf.transforms.resize(1);
    tf.transforms[0].header.frame_id = "0_link";
    tf.transforms[0].child_frame_id = "mocap";
    tf.transforms[0].transform = transformToMsg(X_base_mocap);
    bag.write(topics::kTfStatic, ros::Time(1.0), tf);
  }

  static std::string complaint(const std::vector<std::string>& files) {
    try {
      readInputs(files);
    } catch (const InvalidInput& error) {
      return error.what();
    }
    return "accepted";
  }

  const TemporaryDirectory folder_;
};

TEST_F(SessionBag, ObservationsAreRegisteredIntoTheBaseFrame) {
  const std::string file = path("s.bag");
  rosbag::Bag bag(file, rosbag::bagmode::Write);
  const Pose target = poseAtTime(12.0);
  event(bag, 10.0, "a", TrajectoryEvent::START, &target);
  streams(bag, 10.0, 12.0, "0_link", "mocap");
  registration(bag);
  event(bag, 12.0, "a", TrajectoryEvent::END, &target);
  event(bag, 13.0, "b", TrajectoryEvent::START, &target);
  streams(bag, 13.0, 14.0, "0_link", "mocap");
  event(bag, 14.0, "b", TrajectoryEvent::END);  // not reached
  bag.close();
  const Session session = readSessionBag(file);
  ASSERT_EQ(session.dataset.trajectories.size(), 2u);
  for (const StampedPose& seen : session.dataset.trajectories[0].observations)
    EXPECT_LT((seen.pose.p - poseAtTime(seen.stamp).p).norm(), 1e-12);
  EXPECT_TRUE(session.goals[0].has_target);
  EXPECT_FALSE(session.goals[1].has_target);
  EXPECT_TRUE(holdsSession(file));
}

TEST_F(SessionBag, ADamagedChunkDoesNotHideThatItIsASession) {
  const std::string file = path("s.bag");
  rosbag::Bag bag(file, rosbag::bagmode::Write);
  event(bag, 10.0, "a", TrajectoryEvent::START);
  streams(bag, 10.0, 11.0, "0_link", "mocap");
  registration(bag);
  event(bag, 11.0, "a", TrajectoryEvent::END);
  bag.close();
  ASSERT_EQ(readSessionBag(file).dataset.trajectories.size(), 1u);
  std::fstream bytes(file, std::ios::in | std::ios::out | std::ios::binary);
  std::string content{std::istreambuf_iterator<char>(bytes), std::istreambuf_iterator<char>()};
  const std::size_t time = content.find("time=");  // of its first message
  ASSERT_NE(time, std::string::npos);
  bytes.seekp(static_cast<std::streamoff>(time)).write("conn", 4);
  bytes.close();
  EXPECT_TRUE(holdsSession(file));
  const std::string said = complaint({file});
  EXPECT_NE(said.find(file), std::string::npos) << said;
  EXPECT_NE(said.find("byte "), std::string::npos) << said;
}

TEST_F(SessionBag, PartsOfOneRecordingAreReadAsOne) {
  rosbag::Bag first(path("s_0.bag"), rosbag::bagmode::Write);
  registration(first);
  event(first, 10.0, "a", TrajectoryEvent::START);
  streams(first, 10.0, 11.0, "0_link", "mocap");
  first.close();
  rosbag::Bag second(path("s_1.bag"), rosbag::bagmode::Write);
  streams(second, 11.1, 12.0, "0_link", "mocap");
  event(second, 12.0, "a", TrajectoryEvent::END);
  second.close();
  const Dataset dataset = readInputs({path("s_0.bag"), path("s_1.bag")});
  ASSERT_EQ(dataset.trajectories.size(), 1u);
  EXPECT_EQ(dataset.trajectories[0].commands.size(), 21u);
}

TEST_F(SessionBag, FramesThatCannotBeTrustedAreRefused) {
  rosbag::Bag nameless(path("nameless.bag"), rosbag::bagmode::Write);
  streams(nameless, 10.0, 12.0, "0_link", "");
  nameless.close();
  EXPECT_NE(complaint({path("nameless.bag")}).find("name no frame"), std::string::npos)
      << complaint({path("nameless.bag")});
  rosbag::Bag mixed(path("mixed.bag"), rosbag::bagmode::Write);
  streams(mixed, 10.0, 11.0, "0_link", "0_link");
  streams(mixed, 11.0, 12.0, "1_link", "0_link");
  mixed.close();
  EXPECT_NE(complaint({path("mixed.bag")}).find("2 different frames"), std::string::npos);
  rosbag::Bag lost(path("lost.bag"), rosbag::bagmode::Write);
  streams(lost, 10.0, 12.0, "0_link", "mocap");
  lost.close();
  EXPECT_NE(complaint({path("lost.bag")}).find("no registration of \"mocap\""), std::string::npos);
}

TEST_F(SessionBag, AStreamThatIsMissingIsNamedWithWhatIsThereInstead) {
  rosbag::Bag bag(path("s.bag"), rosbag::bagmode::Write);
  for (int i = 0; i < 20; ++i) {
    const double t = 10.0 + 0.1 * i;
    bag.write(topics::kCommand, ros::Time(t), stampedPoseToMsg(t, poseAtTime(t), "0_link"));
    bag.write("phasespace_gripper_pose_L", ros::Time(t),
              stampedPoseToMsg(t, poseAtTime(t), "0_link"));
  }
  bag.close();
  const std::string text = complaint({path("s.bag")});
  EXPECT_NE(text.find("no message on mocap/measured_cp"), std::string::npos) << text;
  EXPECT_NE(text.find("phasespace_gripper_pose_L [geometry_msgs/PoseStamped]"), std::string::npos)
      << text;
}

TEST_F(SessionBag, StampsThatAreAllZeroAreNamed) {
  rosbag::Bag bag(path("s.bag"), rosbag::bagmode::Write);
  for (int i = 0; i < 20; ++i) {
    const double t = 10.0 + 0.1 * i;
    bag.write(topics::kCommand, ros::Time(t), stampedPoseToMsg(t, poseAtTime(t), "0_link"));
    bag.write(topics::kMocap, ros::Time(t), stampedPoseToMsg(0.0, poseAtTime(t), "0_link"));
  }
  bag.close();
  const std::string text = complaint({path("s.bag")});
  EXPECT_NE(text.find("all 20 stamps are zero"), std::string::npos) << text;
  EXPECT_NE(text.find("mocap_stamp: receipt"), std::string::npos) << text;
}

TEST_F(SessionBag, HomingsAreKnownAndOneInTheMiddleIsAWarning) {
  rosbag::Bag bag(path("s.bag"), rosbag::bagmode::Write);
  for (const double homed : {8.0, 15.0}) {
    std_msgs::Header homing;
    homing.stamp = ros::Time(homed);
    bag.write(topics::kRobotHomed, homing.stamp, homing);
  }
  for (const double start : {10.0, 20.0}) {
    event(bag, start, "t" + std::to_string(start), TrajectoryEvent::START);
    streams(bag, start, start + 2.0, "0_link", "0_link");
    event(bag, start + 2.0, "t" + std::to_string(start), TrajectoryEvent::END);
  }
  registration(bag);
  bag.close();
  EXPECT_EQ(readSessionBag(path("s.bag")).homed_at, (std::vector<double>{8.0, 15.0}));
  const CheckedInputs inputs = readCheckedInputs({path("s.bag")}, {});
  EXPECT_EQ(inputs.homed_at, 15.0);
  bool said = false;
  for (const StreamFinding& finding : inputs.findings) said |= finding.what == "homing";
  EXPECT_TRUE(said);
}

TEST_F(SessionBag, AHomingAfterAllTrajectoriesIsNotWhatTheyWereRecordedAfter) {
  rosbag::Bag bag(path("s.bag"), rosbag::bagmode::Write);
  for (const double homed : {8.0, 30.0}) {
    std_msgs::Header homing;
    homing.stamp = ros::Time(homed);
    bag.write(topics::kRobotHomed, homing.stamp, homing);
  }
  event(bag, 10.0, "t", TrajectoryEvent::START);
  streams(bag, 10.0, 12.0, "0_link", "0_link");
  event(bag, 12.0, "t", TrajectoryEvent::END);
  bag.close();
  const CheckedInputs inputs = readCheckedInputs({path("s.bag")}, {});
  EXPECT_EQ(inputs.homed_at, 8.0);
  ASSERT_FALSE(inputs.findings.empty());
  EXPECT_NE(toText(inputs.findings.back()).find("out of date"), std::string::npos);
}

TEST_F(SessionBag, EncodersOfAnotherFrameAreRegisteredOrLeftOut) {
  for (const bool registered : {true, false}) {
    const std::string file = path(registered ? "known.bag" : "unknown.bag");
    rosbag::Bag bag(file, rosbag::bagmode::Write);
    streams(bag, 10.0, 12.0, "0_link", "0_link");
    for (int i = 0; i < 20; ++i) {
      const double t = 10.0 + 0.1 * i;
      bag.write(topics::kEncoder, ros::Time(t),
                stampedPoseToMsg(t, X_base_mocap.inverse() * poseAtTime(t), "mocap"));
    }
    if (registered) registration(bag);
    bag.close();
    const Dataset dataset = readInputs({file});
    ASSERT_EQ(dataset.trajectories.size(), 1u);
    ASSERT_EQ(dataset.trajectories[0].encoders.empty(), !registered);
    for (const StampedPose& sample : dataset.trajectories[0].encoders)
      EXPECT_LT((sample.pose.p - poseAtTime(sample.stamp).p).norm(), 1e-12);
  }
}

TEST_F(SessionBag, EventsOfAnotherClockAreNamed) {
  rosbag::Bag bag(path("s.bag"), rosbag::bagmode::Write);
  event(bag, 1e5, "a", TrajectoryEvent::START);
  streams(bag, 10.0, 12.0, "0_link", "0_link");
  event(bag, 1e5 + 2.0, "a", TrajectoryEvent::END);
  bag.close();
  EXPECT_NE(complaint({path("s.bag")}).find("compare the stamps"), std::string::npos)
      << complaint({path("s.bag")});
}

TEST_F(SessionBag, StampsThatGoBackAreRefusedWithTheirPlaceAndTheCut) {
  rosbag::Bag bag(path("s.bag"), rosbag::bagmode::Write);
  streams(bag, 10.0, 12.0, "0_link", "0_link");  // 21 messages on each topic
  // The tracker's clock was set back by two seconds; the recorder's was not.
  bag.write(topics::kMocap, ros::Time(12.1), stampedPoseToMsg(10.0, poseAtTime(10.0), "0_link"));
  bag.close();
  const std::string text = complaint({path("s.bag")});
  for (const char* const part :
       {"s.bag: mocap/measured_cp: message 22 has stamp 10.000000, 2.000000 s before",
        "12.000000 of the message before it", "rosbag filter", "t.to_nsec() < 12100000000\""})
    EXPECT_NE(text.find(part), std::string::npos) << part << "\n" << text;
}

TEST_F(SessionBag, RepeatedStampsAndUnsetOnesAreNotOutOfOrder) {
  rosbag::Bag bag(path("s.bag"), rosbag::bagmode::Write);
  streams(bag, 10.0, 12.0, "0_link", "0_link");
  for (const double stamp : {12.0, 0.0, 12.0})  // a frozen frame, and one without a stamp
    bag.write(topics::kMocap, ros::Time(12.1), stampedPoseToMsg(stamp, poseAtTime(12.0), "0_link"));
  bag.close();
  const Dataset dataset = readInputs({path("s.bag")});
  ASSERT_EQ(dataset.trajectories.size(), 1u);
  EXPECT_EQ(dataset.trajectories[0].observations.size(), 23u);
}

TEST_F(SessionBag, PartsAreReadInTheOrderOfTheirNumbers) {
  std::vector<std::string> parts;
  for (const int part : {10, 2, 9}) {  // as a sorted listing of the folder names them
    parts.push_back(path("s_" + std::to_string(part) + ".bag"));
    rosbag::Bag bag(parts.back(), rosbag::bagmode::Write);
    streams(bag, part, part + 0.85, "0_link", "0_link");
    bag.close();
  }
  EXPECT_EQ(complaint(parts), "accepted");
  EXPECT_EQ(readInputs(parts).trajectories[0].commands.front().stamp, 2.0);
}

TEST_F(SessionBag, WhatABagCannotHoldIsNotWritten) {
  Dataset dataset;
  dataset.source = "joints";
  dataset.trajectories.resize(1);
  dataset.trajectories[0].joint_commands.names = {"q1"};
  dataset.trajectories[0].joint_commands.samples.push_back({1.0, Eigen::VectorXd::Zero(1)});
  EXPECT_THROW(writeSessionBag(dataset, path("j.bag")), InvalidInput);
  EXPECT_THROW(readSessionBag(path("j.bag")), InvalidInput);  // there is no such file
}

}  // namespace
}  // namespace raven_correction
