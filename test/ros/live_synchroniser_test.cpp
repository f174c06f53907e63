// SPDX-License-Identifier: BSD-3-Clause
// Is a live pair the pair that synchronise() makes of the same streams, and exact where the motion
// is exactly what interpolation assumes?
#include "raven_correction/ros/live_synchroniser.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "raven_correction/error.h"

namespace raven_correction {
namespace {

constexpr double kStart = 1.7e9;  // Unix time: stamps carry 0.24 us of rounding
constexpr double kStampRounding = 2.4e-7;

/// A screw: constant velocity and constant angular velocity, so that interpolation is exact.
Pose screw(double t) {
  const Eigen::Vector3d v(0.05, -0.02, 0.01);       // [m/s]
  const Eigen::Vector3d w(0.3, 0.5, -0.2);          // [rad/s]
  const Eigen::Quaterniond q0(0.8, 0.0, 0.6, 0.0);  // unit
  return {Eigen::Vector3d(0.1, 0.0, -0.1) + v * t, q0 * expRotation(w * t)};
}

StampedPose screwAt(double t) { return {kStart + t, screw(t)}; }

LiveSynchroniserOptions options(double max_gap) {
  LiveSynchroniserOptions options;
  options.max_gap = max_gap;
  return options;
}

void append(std::vector<LivePair>& all, const std::vector<LivePair>& pairs) {
  all.insert(all.end(), pairs.begin(), pairs.end());
}

TEST(LiveSynchroniser, IsExactOnAScrewMotion) {
  LiveSynchroniser synchroniser(options(0.1));
  std::vector<LivePair> pairs;
  for (int k = 0; k < 100; ++k) {
    append(pairs, synchroniser.addCommand(screwAt(0.02 * k)));
    append(pairs, synchroniser.addObservation(screwAt(0.02 * k + 0.007)));
  }
  ASSERT_EQ(pairs.size(), 99u);  // the last observation is after the last command
  for (const LivePair& pair : pairs) {
    // Speed times the rounding of a stamp, and as much again for the stamps of the neighbours.
    EXPECT_LT((pair.command.p - pair.observation.p).norm(), 2 * 0.06 * kStampRounding);
    EXPECT_LT(rotationAngle(pair.command.q, pair.observation.q), 2 * 0.7 * kStampRounding);
  }
  EXPECT_EQ(synchroniser.waiting(), 1u);
}

TEST(LiveSynchroniser, AgreesWithTheOfflineRuleInAnyOrderOfArrival) {
  for (unsigned seed = 1; seed <= 20; ++seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> uniform(0.0, 1.0);
    Trajectory trajectory;
    trajectory.id = "t";
    const double nan = std::numeric_limits<double>::quiet_NaN();
    for (double t = 0.0; t < 3.0; t += 0.005 + 0.03 * uniform(random)) {
      StampedPose command = screwAt(t);
      if (uniform(random) < 0.05) command.pose = Pose{};  // identity: not a command
      if (uniform(random) < 0.05) command.pose.p.x() = nan;
      trajectory.commands.push_back(command);
      if (uniform(random) < 0.03) t += 0.3;  // a gap
    }
    for (double t = -0.1; t < 3.2; t += 0.002 + 0.02 * uniform(random)) {
      StampedPose seen = screwAt(t);
      if (uniform(random) < 0.05) seen.pose.q.coeffs() *= 1.5;
      trajectory.observations.push_back(seen);
      if (uniform(random) < 0.05) trajectory.observations.push_back(seen);  // a frozen frame
    }
    Dataset dataset;
    dataset.trajectories.push_back(trajectory);
    SynchronisationOptions offline;
    offline.max_gap = 0.1;
    const SynchronisedTrajectory expected = synchronise(dataset, offline).front();

    LiveSynchroniser synchroniser(options(0.1));
    std::vector<LivePair> pairs;
    std::size_t c = 0, o = 0;
    while (c < trajectory.commands.size() || o < trajectory.observations.size()) {
      const bool command = o == trajectory.observations.size() ||
                           (c < trajectory.commands.size() && uniform(random) < 0.5);
      append(pairs, command ? synchroniser.addCommand(trajectory.commands[c++])
                            : synchroniser.addObservation(trajectory.observations[o++]));
    }
    ASSERT_EQ(pairs.size(), expected.pairs.size()) << "seed " << seed;
    for (std::size_t i = 0; i < pairs.size(); ++i) {
      const StampedPose& sample = expected.observations.samples[expected.pairs[i].sample];
      EXPECT_EQ(pairs[i].stamp, sample.stamp);
      EXPECT_EQ(pairs[i].command.p, expected.pairs[i].command.p);
      EXPECT_EQ(pairs[i].command.q.coeffs(), expected.pairs[i].command.q.coeffs());
      EXPECT_EQ(pairs[i].observation.p, sample.pose.p);
    }
    for (const Fate fate : {Fate::kKept, Fate::kNotUnit, Fate::kRepeated, Fate::kCommandGap})
      EXPECT_EQ(synchroniser.fates()[fate], expected.fates[fate]) << fateName(fate);
  }
}

TEST(LiveSynchroniser, WaitsForALaterCommandInsteadOfExtrapolating) {
  LiveSynchroniser synchroniser(options(0.1));
  EXPECT_TRUE(synchroniser.addCommand(screwAt(0.00)).empty());
  EXPECT_TRUE(synchroniser.addObservation(screwAt(0.01)).empty());
  EXPECT_EQ(synchroniser.waiting(), 1u);
  EXPECT_EQ(synchroniser.addCommand(screwAt(0.02)).size(), 1u);
  EXPECT_EQ(synchroniser.waiting(), 0u);
}

TEST(LiveSynchroniser, BridgesNoGap) {
  LiveSynchroniser synchroniser(options(0.1));
  synchroniser.addCommand(screwAt(0.0));
  synchroniser.addObservation(screwAt(0.05));
  EXPECT_TRUE(synchroniser.addCommand(screwAt(0.2)).empty());
  EXPECT_EQ(synchroniser.fates()[Fate::kCommandGap], 1u);
}

TEST(LiveSynchroniser, TakesTheGapFromThePeriodOfSlowCommands) {
  LiveSynchroniser synchroniser(options(0.0));
  std::size_t pairs = 0;
  for (int k = 0; k < 20; ++k) {  // 2 Hz: any fixed limit made for 50 Hz would refuse it
    synchroniser.addObservation(screwAt(0.5 * k - 0.2));
    pairs += synchroniser.addCommand(screwAt(0.5 * k)).size();
  }
  EXPECT_EQ(pairs, 19u);
  EXPECT_NEAR(synchroniser.gapLimit(), 2.5, 1e-5);
}

TEST(LiveSynchroniser, StartsAnewWhenTheStampsJumpBack) {
  LiveSynchroniser synchroniser(options(0.1));
  for (int k = 0; k < 10; ++k) synchroniser.addCommand(screwAt(100.0 + 0.02 * k));
  synchroniser.addObservation(screwAt(101.0));  // waits, and must not meet a command of the past
  std::size_t pairs = 0;
  for (int k = 0; k < 10; ++k) {
    pairs += synchroniser.addCommand(screwAt(0.02 * k)).size();
    pairs += synchroniser.addObservation(screwAt(0.02 * k + 0.01)).size();
  }
  EXPECT_EQ(synchroniser.restarts(), 1u);
  EXPECT_EQ(pairs, 9u);
}

TEST(LiveSynchroniser, RefusesTheStampZero) {
  LiveSynchroniser synchroniser(options(0.1));
  synchroniser.addCommand({0.0, screw(0.0)});
  synchroniser.addObservation({0.0, screw(0.0)});
  EXPECT_EQ(synchroniser.kept(), 0u);
  EXPECT_EQ(synchroniser.waiting(), 0u);
  EXPECT_EQ(synchroniser.fates()[Fate::kNotFinite], 1u);
}

TEST(LiveSynchroniser, KeepsItsMemoryBoundedWhenOneStreamIsSilent) {
  LiveSynchroniser synchroniser(options(0.1));
  for (int k = 0; k < 60000; ++k) synchroniser.addCommand(screwAt(0.001 * k));
  EXPECT_LE(synchroniser.kept(), 10002u);  // twice the horizon of 5 s at 1 kHz
  synchroniser.clear();
  for (int k = 0; k < 60000; ++k) synchroniser.addObservation(screwAt(0.001 * k));
  EXPECT_LE(synchroniser.waiting(), 5002u);
  EXPECT_EQ(synchroniser.fates()[Fate::kNoCommand] + synchroniser.waiting(), 60000u);
}

TEST(LiveSynchroniser, RefusesOptionsThatMeanNothing) {
  LiveSynchroniserOptions bad;
  bad.horizon = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(LiveSynchroniser{bad}, InvalidInput);
  bad = {};
  bad.max_gap = -1.0;
  EXPECT_THROW(LiveSynchroniser{bad}, InvalidInput);
}

}  // namespace
}  // namespace raven_correction
