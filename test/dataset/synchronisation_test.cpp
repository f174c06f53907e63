// SPDX-License-Identifier: BSD-3-Clause
#include "raven_correction/dataset/synchronisation.h"

#include <gtest/gtest.h>

#include <cmath>

#include "raven_correction/dataset/delay.h"
#include "raven_correction/dataset/split.h"
#include "raven_correction/error.h"
#include "support/random_poses.h"

namespace raven_correction {
namespace {

/// Straight motion with constant turn: linear interpolation of it is exact.
Pose straight(double t) {
  return {{0.03 * t, 0.1 - 0.02 * t, 0.05 * t}, expRotation({0.0, 0.3 * t, 0.0})};
}

/// A curved motion that a delay can be read from.
Pose curved(double t) {
  return {{0.03 * std::sin(3.0 * t), 0.04 * std::cos(2.0 * t), 0.02 * std::sin(t)},
          expRotation({0.2 * std::sin(t), 0.0, 0.0})};
}

template <typename Motion>
Dataset record(const Motion& motion, double delay, double duration = 4.0) {
  Dataset dataset;
  Trajectory trajectory;
  trajectory.id = "t0";
  for (int i = 0; i <= static_cast<int>(duration * 50.0); ++i) {
    const double t = 100.0 + 0.02 * i;
    trajectory.commands.push_back({t, motion(t - 100.0)});
  }
  for (int i = 0; i <= static_cast<int>(duration * 120.0); ++i) {
    const double t = 100.0031 + i / 120.0;
    trajectory.observations.push_back({t, motion(t - 100.0 - delay)});
  }
  dataset.trajectories.push_back(trajectory);
  return dataset;
}

TEST(Synchronise, IsExactOnAnalyticMotion) {
  const double delay = 0.123;
  SynchronisationOptions options;
  options.delay = delay;
  const auto result = synchronise(record(straight, delay), options);
  ASSERT_EQ(result.size(), 1u);
  EXPECT_GT(result[0].pairs.size(), 400u);
  for (const CommandPair& pair : result[0].pairs) {
    const Pose& observed = result[0].observations.samples[pair.sample].pose;
    EXPECT_LT((pair.command.p - observed.p).norm(), 1e-12);
    EXPECT_LT(rotationAngle(pair.command.q, observed.q), 1e-12);
  }
}

TEST(Synchronise, EverySampleHasExactlyOneFate) {
  Dataset dataset = record(straight, 0.0);
  PoseStream& observations = dataset.trajectories[0].observations;
  PoseStream& commands = dataset.trajectories[0].commands;
  observations[10].pose.p.x() = std::nan("");
  observations[20].pose.q.coeffs() *= 1.1;
  observations[31] = observations[30];                             // frozen frame with its stamp
  observations[41].pose = observations[40].pose;                   // frozen frame with a new stamp
  commands[60].pose = Pose();                                      // identity
  commands.erase(commands.begin() + 100, commands.begin() + 115);  // a gap of 0.32 s
  observations.push_back({200.0, straight(5.0)});                  // after the last command
  const auto result = synchronise(dataset, {});
  const FateCounts& fates = result[0].fates;
  EXPECT_EQ(fates.total(), observations.size());
  EXPECT_EQ(fates[Fate::kKept], result[0].pairs.size());
  EXPECT_EQ(fates[Fate::kNotFinite], 1u);
  EXPECT_EQ(fates[Fate::kNotUnit], 1u);
  EXPECT_EQ(fates[Fate::kRepeated], 2u);
  EXPECT_GE(fates[Fate::kNoCommand], 1u);
  EXPECT_NEAR(static_cast<double>(fates[Fate::kCommandGap]), 0.32 * 120.0, 1.0);
  EXPECT_EQ(result[0].identity_commands, 1u);
  for (const CommandPair& pair : result[0].pairs) {  // nothing was interpolated through dirt
    const Pose& observed = result[0].observations.samples[pair.sample].pose;
    EXPECT_LT((pair.command.p - observed.p).norm(), 1e-12);
  }
}

TEST(Synchronise, RefusesADataSetWithoutBothStreams) {
  Dataset dataset = record(straight, 0.0);
  dataset.trajectories[0].commands.clear();
  dataset.source = "some.bag";
  try {
    synchronise(dataset, {});
    FAIL();
  } catch (const InvalidInput& error) {
    EXPECT_NE(std::string(error.what()).find("some.bag"), std::string::npos);
  }
}

TEST(Delay, IsFoundThroughARigidTransformAndOutliers) {
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  for (const double delay : {0.055, 0.163, 0.31}) {
    Dataset dataset = record(curved, delay, 10.0);
    const Pose X = randomPose(random);
    for (StampedPose& sample : dataset.trajectories[0].observations) {
      sample.pose = X * sample.pose;
      sample.pose.p += randomVector(random, 1e-4);
      if (uniform(random) < 0.2) sample.pose.p += randomVector(random, 0.05);
    }
    const DelayResult result = estimateDelay(dataset, {});
    EXPECT_EQ(result.status, DelayResult::Status::kOk);
    EXPECT_NEAR(result.delay, delay, 0.003);
  }
}

TEST(Delay, IsNotClaimedWhereNothingMoves) {
  const auto rest = [](double) { return Pose{{0.1, 0.2, 0.3}, {1, 0, 0, 0}}; };
  std::mt19937_64 random(2);
  Dataset dataset = record(rest, 0.1);
  for (StampedPose& sample : dataset.trajectories[0].observations)
    sample.pose.p += randomVector(random, 1e-4);
  const DelayResult result = estimateDelay(dataset, {});
  EXPECT_EQ(result.status, DelayResult::Status::kNotObservable);
  EXPECT_EQ(result.delay, 0.0);
}

TEST(HoldOut, IsParsedStrictly) {
  const HoldOut hold_out = parseHoldOut("2/5");
  EXPECT_TRUE(hold_out.tests(2));
  EXPECT_TRUE(hold_out.tests(7));
  EXPECT_FALSE(hold_out.tests(3));
  for (const char* text : {"5/5", "-1/5", "1", "1/1", "a/5", "1/5x", ""})
    EXPECT_THROW(parseHoldOut(text), InvalidInput) << text;
}

}  // namespace
}  // namespace raven_correction
