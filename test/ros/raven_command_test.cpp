// SPDX-License-Identifier: BSD-3-Clause
// The bytes of other packages' messages: what is read from them, what is written, and that no bytes
// whatever are read past their end. The real definitions are held against in
// nodes/raven_command.py.
#include "raven_correction/ros/raven_command.h"

#include <gtest/gtest.h>

#include <random>

#include "raven_correction/ros/pose_command.h"
#include "raven_correction/ros/robot_state.h"
#include "support/raven_bytes.h"

namespace raven_correction {
namespace {

TEST(RavenCommand, IsReadFieldByField) {
  RavenCommandContent content;
  const auto bytes = command({"L", "R"});
  ASSERT_TRUE(readRavenCommand(bytes, content));
  EXPECT_EQ(content.stamp, ros::Time(100, 500000000));
  EXPECT_EQ(content.frame, "0_link");
  EXPECT_TRUE(content.pedal_down);
  ASSERT_EQ(content.arm_count, 2u);
  EXPECT_EQ(content.arms[0].name, "L");
  EXPECT_EQ(content.arms[1].name, "R");
  EXPECT_TRUE(content.arms[1].active);
  EXPECT_EQ(content.arms[1].pose_option, 5);
  EXPECT_EQ(content.arms[0].pose.p, Eigen::Vector3d(0.1, 0.2, 0.3));
  EXPECT_EQ(content.arms[0].pose.q.w(), -0.5);
  EXPECT_EQ(content.arms[1].pose.p.z(), 10.3);
}

TEST(RavenCommand, OnlyThePartsThatAreAskedForAreWritten) {
  const auto before = command({"L", "R"});
  RavenCommandContent content;
  ASSERT_TRUE(readRavenCommand(before, content));
  const std::size_t place = content.arms[1].place;
  const Pose pose{{1.0, 2.0, 3.0}, {0.1, 0.2, 0.3, 0.4}};
  for (const bool position : {false, true})
    for (const bool orientation : {false, true}) {
      auto after = before;
      writeRavenPose(after, place, pose, position, orientation);
      for (std::size_t i = 0; i < after.size(); ++i) {
        const bool in_position = i >= place && i < place + 24;
        const bool in_orientation = i >= place + 24 && i < place + 56;
        if ((in_position && position) || (in_orientation && orientation)) continue;
        EXPECT_EQ(after[i], before[i]) << i;
      }
      ASSERT_TRUE(readRavenCommand(after, content));
      if (position) {
        EXPECT_EQ(content.arms[1].pose.p, pose.p);
      }
      if (orientation) {
        EXPECT_EQ(content.arms[1].pose.q.coeffs(), pose.q.coeffs());
      }
    }
}

TEST(RavenCommand, CutOrLongerBytesAreRefused) {
  const auto whole = command({"L", "R"});
  RavenCommandContent content;
  for (std::size_t size = 0; size < whole.size(); ++size)
    EXPECT_FALSE(
        readRavenCommand({whole.begin(), whole.begin() + static_cast<long>(size)}, content))
        << size;
  auto longer = whole;
  longer.push_back(0);
  EXPECT_FALSE(readRavenCommand(longer, content));
}

TEST(RavenCommand, NamesThatDoNotMatchTheArmsAreRefused) {
  RavenCommandContent content;
  EXPECT_FALSE(readRavenCommand(command({"L", "L"}), content));
  EXPECT_FALSE(readRavenCommand(command({"1", "2", "3", "4", "5", "6", "7", "8", "9"}), content));
  EXPECT_TRUE(readRavenCommand(command({}), content));
  Bytes bytes;
  bytes.header("0_link").put(std::string()).put<std::uint8_t>(1).put<std::uint8_t>(1);
  bytes.put<std::uint32_t>(1).put(std::string("L")).put<std::uint32_t>(0);
  EXPECT_FALSE(readRavenCommand(bytes.get(), content));
}

TEST(RavenCommand, RandomBytesAreNeverReadPastTheirEnd) {
  // Under AddressSanitizer this finds every step outside (./run sanitize).
  std::mt19937_64 random(1);
  const auto whole = command({"L", "R"});
  RavenCommandContent content;
  for (int i = 0; i < 200000; ++i) {
    auto bytes = whole;
    const int changes = 1 + static_cast<int>(random() % 4);
    for (int k = 0; k < changes; ++k)
      bytes[random() % bytes.size()] = static_cast<std::uint8_t>(random());
    bytes.resize(random() % (bytes.size() + 1));
    bytes.shrink_to_fit();
    if (readRavenCommand(bytes, content)) {
      EXPECT_LE(content.arm_count, RavenCommandContent::kMaxArms);
      for (std::size_t k = 0; k < content.arm_count; ++k)
        EXPECT_LE(content.arms[k].place + 56, bytes.size());
    }
    readRobotState("b1bd4021639d9d9c5fbfff78d6ff3158", bytes);
    readRobotState("2489ec3d939b556c05d31ea2958841b2", bytes);
    readRobotState("ce9e7f4969049d8bb365de3c98461a01", bytes);
  }
}

TEST(RavenCommand, WhatIsAskedOfAnArmFollowsItsFlags) {
  using Kind = ArmRequest::Kind;
  const std::vector<std::string> arms{"R"};
  CommandRequest request;
  const auto kindOf = [&](std::uint8_t option, bool active = true, bool pedal_down = true) {
    RavenCommand message;
    message.bytes = command({"L", "R"}, option, active, pedal_down);
    EXPECT_TRUE(readCommand(message, arms, request));
    return request.arms[0].kind;
  };
  EXPECT_EQ(kindOf(5), Kind::kPose);
  EXPECT_EQ(request.arms[0].pose.p.x(), 10.1);
  EXPECT_EQ(kindOf(0), Kind::kInactive);
  EXPECT_EQ(kindOf(2), Kind::kInactive);  // relative, but not enabled
  EXPECT_EQ(kindOf(5, false), Kind::kInactive);
  EXPECT_EQ(kindOf(5, true, false), Kind::kInactive);
  for (const std::uint8_t option : {15, 7, 13, 3, 12}) EXPECT_EQ(kindOf(option), Kind::kRelative);
  EXPECT_EQ(kindOf(1), Kind::kPose);
  EXPECT_TRUE(request.arms[0].position && !request.arms[0].orientation);
  EXPECT_EQ(kindOf(4), Kind::kPose);
  EXPECT_TRUE(!request.arms[0].position && request.arms[0].orientation);
  RavenCommand other;
  other.bytes = command({"L"});
  ASSERT_TRUE(readCommand(other, arms, request));
  EXPECT_EQ(request.arms[0].kind, Kind::kAbsent);
}

TEST(RobotState, IsReadFromEveryStack) {
  const auto operating = [](const std::string& state, bool homed) {
    return Bytes().header("").put(state).put<std::uint8_t>(homed).put<std::uint8_t>(0).get();
  };
  const std::string crtk = "b1bd4021639d9d9c5fbfff78d6ff3158";
  EXPECT_TRUE(readRobotState(crtk, operating("ENABLED", true))->ready());
  EXPECT_FALSE(readRobotState(crtk, operating("ENABLED", false))->ready());
  EXPECT_FALSE(readRobotState(crtk, operating("PAUSED", true))->ready());
  EXPECT_FALSE(readRobotState("0123", operating("ENABLED", true)));
  for (int level = 0; level < 4; ++level) {
    const auto berkeley = Bytes().header("/0_link").put(static_cast<std::uint8_t>(level)).get();
    EXPECT_EQ(readRobotState("2489ec3d939b556c05d31ea2958841b2", berkeley)->ready(), level >= 2);
    const auto uw = Bytes().header("").put(static_cast<std::int32_t>(level)).get();
    EXPECT_EQ(readRobotState("ce9e7f4969049d8bb365de3c98461a01", uw)->ready(), level >= 2);
  }
}

}  // namespace
}  // namespace raven_correction
