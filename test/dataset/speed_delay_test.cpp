// SPDX-License-Identifier: BSD-3-Clause
// Is the delay between two streams found from speeds alone, whatever constant error lies between
// them, and is it said where it cannot be?
#include "raven_correction/dataset/speed_delay.h"

#include <gtest/gtest.h>

#include <cmath>

#include "raven_correction/error.h"

namespace raven_correction {
namespace {

constexpr double kDelay = 0.137;  // between two steps of the search [s]

/// Two motions, an hour apart, seen from another frame.
Dataset session(double size) {
  const Pose X_seen_base{{0.3, -0.1, 0.2}, expRotation({0.3, 0.2, -0.5})};
  const auto motion = [&](double t) {
    return Pose{{size * std::sin(2.0 * t), size * std::cos(1.3 * t), size * std::sin(0.7 * t)},
                expRotation({0.1 * std::sin(t), 0.0, 0.0})};
  };
  Dataset dataset;
  for (const double start : {1000.0, 4600.0}) {
    Trajectory trajectory;
    for (double t = start; t < start + 8.0; t += 0.02)
      trajectory.commands.push_back({t, motion(t)});
    for (double t = start + 0.3; t < start + 8.0; t += 1.0 / 120.0)
      trajectory.observations.push_back({t, X_seen_base * motion(t - kDelay)});
    dataset.trajectories.push_back(trajectory);
  }
  return dataset;
}

TEST(SpeedDelay, IsFoundBetweenTheStepsOfTheSearch) {
  const DelayResult result = estimateSpeedDelay(session(0.05), {});
  EXPECT_EQ(result.status, DelayResult::Status::kOk);
  EXPECT_NEAR(result.delay, kDelay, 0.001);
}

TEST(SpeedDelay, AtTheLimitOfTheSearchIsSaid) {
  SpeedDelayProblem problem;
  problem.max = 0.1;
  const DelayResult result = estimateSpeedDelay(session(0.05), problem);
  EXPECT_EQ(result.status, DelayResult::Status::kAtLimit);
  EXPECT_EQ(result.delay, 0.1);
}

TEST(SpeedDelay, IsNotObservableAtRestOrWhereSpeedsHaveNothingInCommon) {
  EXPECT_EQ(estimateSpeedDelay(session(1e-5), {}).status, DelayResult::Status::kNotObservable);
  EXPECT_EQ(estimateSpeedDelay({}, {}).status, DelayResult::Status::kNotObservable);
  Dataset other = session(0.05);
  for (Trajectory& trajectory : other.trajectories)
    for (StampedPose& seen : trajectory.observations)
      seen.pose.p = {0.05 * std::sin(11.0 * seen.stamp), 0.0, 0.0};
  EXPECT_EQ(estimateSpeedDelay(other, {}).status, DelayResult::Status::kNotObservable);
}

TEST(SpeedDelay, SearchThatIsNoneIsRefused) {
  SpeedDelayProblem problem;
  problem.step = 0.0;
  EXPECT_THROW(estimateSpeedDelay(session(0.05), problem), InvalidInput);
  problem.step = 0.01;
  problem.min = problem.max;
  EXPECT_THROW(estimateSpeedDelay(session(0.05), problem), InvalidInput);
}

}  // namespace
}  // namespace raven_correction
