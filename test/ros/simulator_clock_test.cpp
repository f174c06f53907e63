// SPDX-License-Identifier: BSD-3-Clause
// Simulated time: its rate, and what a late or a backward call does to it.
#include "raven_correction/ros/simulator_clock.h"

#include <gtest/gtest.h>

#include <limits>

#include "raven_correction/error.h"

namespace raven_correction {
namespace {

TEST(SimulatorClock, RunsAtItsRateFromItsStart) {
  SimulatorClock clock(4.0, 1000.0, 0.01);
  EXPECT_EQ(clock.advance(77.0), 1000.0);  // the origin of the steady clock does not count
  for (int i = 1; i <= 1000; ++i) clock.advance(77.0 + 1e-3 * i);
  EXPECT_NEAR(clock.time(), 1004.0, 1e-9);
}

TEST(SimulatorClock, SlowsDownRatherThanJumps) {
  SimulatorClock clock(4.0, 0.0, 0.01);
  clock.advance(0.0);
  EXPECT_DOUBLE_EQ(clock.advance(5.0), 0.01);          // 5 s late: one step, no more
  EXPECT_NEAR(clock.advance(5.001), 0.014, 1e-12);     // and what was lost stays lost
  EXPECT_DOUBLE_EQ(clock.advance(4.0), clock.time());  // a steady clock does not run backwards
  EXPECT_GE(clock.advance(4.001), 0.014);
}

TEST(SimulatorClock, RefusesWhatIsNotARate) {
  constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
  for (const double rate : {0.0, -1.0, kNaN, std::numeric_limits<double>::infinity()})
    EXPECT_THROW(SimulatorClock(rate, 0.0, 0.01), InvalidInput) << rate;
  EXPECT_THROW(SimulatorClock(1.0, kNaN, 0.01), InvalidInput);
  EXPECT_THROW(SimulatorClock(1.0, 0.0, 0.0), InvalidInput);
}

}  // namespace
}  // namespace raven_correction
