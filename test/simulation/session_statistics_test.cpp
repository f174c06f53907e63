// SPDX-License-Identifier: BSD-3-Clause
// Figures of a recording whose errors are known exactly.
#include "raven_correction/simulation/session_statistics.h"

#include <gtest/gtest.h>

#include "raven_correction/error.h"
#include "raven_correction/simulation/session.h"
#include "simulation/simulations.h"

namespace raven_correction {
namespace {

/// A clean session with linear set-points, so that the delay is the only thing between command and
/// observation besides what a test adds.
SimulationConfig clean() {
  SimulationConfig config = shippedSimulation("nominal");
  config.setpoints = SetpointMode::kLinear;
  config.motion_capture.noise = 1e-6;  // none at all would make every pose at rest a repeated one
  return config;
}

TEST(SessionStatistics, FindsWhatWasPutIn) {
  SimulationConfig config = clean();
  config.set(effectWith("command_delay", config.robot, {{"tau", 0.12}}));
  config.set(
      effectWith("base_registration", config.robot, {{"x", 0.01}, {"y", -0.02}, {"z", 0.02}}));
  config.set(effectWith("tool_offset", config.robot, {{"rx", 0.2}}));
  config.motion_capture.repeat_probability = 0.1;
  const SessionStatistics s = sessionStatistics(simulateSession(config, 30, 1));
  EXPECT_NEAR(s.delay, 0.12, 0.01);  // one of the estimator's steps
  EXPECT_NEAR(s.raw_position_norm, 0.03, 0.001);
  EXPECT_NEAR(s.raw_angle_median, 0.2, 0.005);
  EXPECT_LT(s.rigid_position_median, 2e-4);
  EXPECT_LT(s.angle_median, 2e-3);
  EXPECT_EQ(s.wrong_share, 0.0);
  EXPECT_NEAR(s.repeated_share, 0.1, 0.02);
  EXPECT_NEAR(s.period_median, 1.0 / 120.0, 1e-6);
}

TEST(SessionStatistics, SeesDirt) {
  SimulationConfig config = clean();
  config.motion_capture.swap_rate = 0.3;
  config.motion_capture.swap_time = 0.2;
  config.motion_capture.gap_rate = 1.0;
  const SessionStatistics s = sessionStatistics(simulateSession(config, 30, 1));
  EXPECT_NEAR(s.wrong_share, 0.3 * 0.2 / 1.06, 0.03);
  EXPECT_GT(s.gap_share, 0.0);
  EXPECT_GT(s.jump_share, 0.0);
}

// The shipped simulation against the figures of the measured session (CASE 2014, left arm), with
// the tolerances that a session of another length and other motions needs.
TEST(SessionStatistics, CaseSessionIsLikeTheMeasuredOne) {
  const SessionStatistics s =
      sessionStatistics(simulateSession(shippedSimulation("raven2_left_case2014"), 90, 1));
  EXPECT_NEAR(s.raw_position_norm, 0.0266, 0.003);
  EXPECT_NEAR(57.2958 * s.raw_angle_median, 19.7, 4.0);
  EXPECT_NEAR(s.delay, 0.15, 0.05);
  EXPECT_NEAR(s.rigid_position_median, 0.0036, 0.001);
  EXPECT_NEAR(57.2958 * s.angle_median, 7.8, 2.0);
  EXPECT_NEAR(s.repeated_share, 0.093, 0.02);
}

TEST(SessionStatistics, RowsStandSideBySide) {
  SessionStatistics measured;
  SessionStatistics simulated;
  measured.raw_position_norm = 0.0264;
  simulated.raw_position_norm = 0.0262;
  const std::vector<StatisticsRow> rows = compareStatistics(measured, simulated);
  EXPECT_EQ(rows.front().unit, "mm");
  EXPECT_DOUBLE_EQ(rows.front().measured, 26.4);
  EXPECT_DOUBLE_EQ(rows.front().simulated, 26.2);
  EXPECT_THROW(sessionStatistics(Dataset()), InvalidInput);
}

}  // namespace
}  // namespace raven_correction
