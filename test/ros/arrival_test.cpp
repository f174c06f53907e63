// SPDX-License-Identifier: BSD-3-Clause
// When a command acts.
#include "raven_correction/ros/arrival.h"

#include <gtest/gtest.h>

#include <limits>

#include "raven_correction/error.h"

namespace raven_correction {
namespace {

TEST(Arrival, BelievesStampsNearNowOnly) {
  Arrival arrival(0.25);
  EXPECT_EQ(arrival.actingTime(100.0, 99.75), 99.75);
  EXPECT_EQ(arrival.actingTime(100.0, 100.25), 100.25);
  EXPECT_EQ(arrival.actingTime(101.0, 100.7), 101.0);
  EXPECT_EQ(arrival.actingTime(102.0, 0.0), 102.0);
  EXPECT_EQ(arrival.actingTime(103.0, std::numeric_limits<double>::quiet_NaN()), 103.0);
}

TEST(Arrival, NeverRunsBackwardsUnlessTheClockDoes) {
  Arrival arrival(0.25);
  EXPECT_EQ(arrival.actingTime(100.0, 100.1), 100.1);
  EXPECT_EQ(arrival.actingTime(100.0, 99.9), 100.1);
  EXPECT_EQ(arrival.actingTime(50.0, 50.0), 50.0) << "the clock was set back";
  arrival.reset();
  EXPECT_EQ(arrival.actingTime(49.9, 49.8), 49.8) << "a new start knows no last one";
}

TEST(Arrival, RefusesAToleranceThatIsNone) {
  EXPECT_THROW(Arrival(-0.1), InvalidInput);
  EXPECT_THROW(Arrival{std::numeric_limits<double>::infinity()}, InvalidInput);
}

}  // namespace
}  // namespace raven_correction
