// SPDX-License-Identifier: BSD-3-Clause
// Does an observation get the trajectory that the bag will give it?
#include "raven_correction/ros/trajectory_windows.h"

#include <gtest/gtest.h>

namespace raven_correction {
namespace {

TEST(TrajectoryWindows, HoldFromStartToHalfASecondAfterTheEnd) {
  TrajectoryWindows windows;
  windows.start("t1", 10.0);
  EXPECT_EQ(windows.at(9.9), "");
  EXPECT_EQ(windows.at(1e9), "t1");  // still open
  EXPECT_TRUE(windows.end("t1", 12.0));
  EXPECT_EQ(windows.at(12.5), "t1");
  EXPECT_EQ(windows.at(12.6), "");
}

TEST(TrajectoryWindows, LetTheLaterTrajectoryWinWhereTwoOverlap) {
  TrajectoryWindows windows;
  windows.start("t1", 10.0);
  windows.end("t1", 12.0);
  windows.start("t2", 12.2);
  EXPECT_EQ(windows.at(12.1), "t1");
  EXPECT_EQ(windows.at(12.3), "t2");
}

TEST(TrajectoryWindows, EndATrajectoryThatWasNotEndedWhereTheNextBegins) {
  TrajectoryWindows windows;
  windows.start("t1", 10.0);
  windows.start("t2", 20.0);
  EXPECT_FALSE(windows.end("t1", 21.0));
  EXPECT_EQ(windows.at(15.0), "t1");
  EXPECT_EQ(windows.at(20.1), "t2");
}

TEST(TrajectoryWindows, IgnoreAnEndWithoutItsStart) {
  TrajectoryWindows windows;
  EXPECT_FALSE(windows.end("t1", 1.0));
  windows.start("t2", 2.0);
  windows.end("t2", 3.0);
  EXPECT_FALSE(windows.end("t2", 4.0));
  EXPECT_EQ(windows.at(3.8), "");
}

}  // namespace
}  // namespace raven_correction
