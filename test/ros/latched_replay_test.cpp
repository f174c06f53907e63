// SPDX-License-Identifier: BSD-3-Clause
#include "raven_correction/ros/latched_replay.h"

#include <gtest/gtest.h>

#include <boost/make_shared.hpp>

namespace raven_correction {
namespace {

boost::shared_ptr<ros::M_string> connection(const std::string& latching) {
  const auto header = boost::make_shared<ros::M_string>();
  (*header)["callerid"] = "/planner";
  if (!latching.empty()) (*header)["latching"] = latching;
  return header;
}

TEST(LatchedReplay, IsTheFirstMessageOfEachLatchedConnection) {
  LatchedReplay replay;
  const auto latched = connection("1"), plain = connection("0"), old_roscpp = connection("");
  EXPECT_TRUE(replay.isReplay(latched));
  EXPECT_FALSE(replay.isReplay(latched));
  EXPECT_FALSE(replay.isReplay(plain));
  EXPECT_FALSE(replay.isReplay(old_roscpp));
  EXPECT_FALSE(replay.isReplay(nullptr));
  const auto another = connection("1");
  EXPECT_TRUE(replay.isReplay(another));
  EXPECT_FALSE(replay.isReplay(latched));
}

TEST(LatchedReplay, APublisherOfTheSameNameThatComesBackReplaysAgain) {
  LatchedReplay replay;
  for (int i = 0; i < 100; ++i) {
    auto latched = connection("1");
    EXPECT_TRUE(replay.isReplay(latched)) << i;
    EXPECT_FALSE(replay.isReplay(latched)) << i;
  }
}

}  // namespace
}  // namespace raven_correction
