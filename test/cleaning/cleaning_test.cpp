// SPDX-License-Identifier: BSD-3-Clause
#include "raven_correction/cleaning/cleaning.h"

#include <gtest/gtest.h>

#include "raven_correction/cleaning/least_median.h"
#include "raven_correction/error.h"
#include "support/random_poses.h"

namespace raven_correction {
namespace {

constexpr double kNoise = 2e-4;  // of each coordinate [m], and of each rotation [rad]

LeastMedianProblem withOutliers(const Pose& X, double share, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  LeastMedianProblem problem;
  for (int i = 0; i < 400; ++i) {
    const Pose from = randomPose(random);
    Pose to = X * from;
    to.p += randomVector(random, kNoise);
    to.q = to.q * expRotation(randomVector(random, kNoise));
    if (i < share * 400) {  // gross, and all in one direction, so that they pull
      to.p += Eigen::Vector3d(0.08, 0.05, -0.1) + randomVector(random, 0.02);
      to.q = to.q * expRotation({1.0, 0.4, 0.0});
    }
    problem.from.push_back(from);
    problem.to.push_back(to);
  }
  return problem;
}

TEST(LeastMedian, SurvivesFortyPercentGrossOutliers) {
  std::mt19937_64 random(1);
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    const Pose X = randomPose(random);
    const LeastMedianResult result = fitLeastMedian(withOutliers(X, 0.4, seed));
    ASSERT_EQ(result.status, LeastMedianResult::Status::kOk);
    // The final fit uses the better half, 200 pairs, 120 or more of them good. Their positions,
    // with a lever of 0.05 m, know the turn to 2e-4 / (0.05 sqrt(2 * 120)) = 2.6e-4 rad per axis,
    // their rotations ten times better; least squares with L = 0.05 m weights both alike: 1.3e-4.
    // Five deviations of that, and of 2e-4 / sqrt(120) m in the position.
    EXPECT_LT((result.X_to_from.p - X.p).norm(), 5.0 * 3.2e-5 + 0.05 * 6.5e-4);
    EXPECT_LT(rotationAngle(result.X_to_from.q, X.q), 6.5e-4);
    // Residual of a good pair: sqrt(3) sigma in position, little in rotation; the scale is of
    // that order, not of the outliers'.
    EXPECT_GT(result.scale, kNoise);
    EXPECT_LT(result.scale, 5.0 * kNoise);
  }
}

TEST(LeastMedian, SaysWhenThereIsTooLittle) {
  LeastMedianProblem problem = withOutliers(Pose(), 0.0, 1);
  problem.from.resize(5);
  problem.to.resize(5);
  EXPECT_EQ(fitLeastMedian(problem).status, LeastMedianResult::Status::kTooFewPairs);
  problem.to.resize(4);
  EXPECT_THROW(fitLeastMedian(problem), InvalidInput);
}

/// 10 trajectories of 40 good samples about one orientation.
std::vector<CleaningSample> goodSamples() {
  std::mt19937_64 random(2);
  const Pose X{{0.01, -0.02, 0.015}, expRotation({0.1, 0.0, 0.05})};
  const Eigen::Quaterniond centre = randomRotation(random);
  std::vector<CleaningSample> samples;
  for (std::size_t k = 0; k < 10; ++k)
    for (int i = 0; i < 40; ++i) {
      CleaningSample sample;
      sample.trajectory = k;
      sample.observation = {randomVector(random, 0.02),
                            centre * expRotation(randomVector(random, 0.1))};
      sample.command = X * sample.observation;
      sample.command.p += randomVector(random, 1e-3);
      sample.step = i == 0 ? 0.0 : 0.02;
      samples.push_back(sample);
    }
  return samples;
}

TEST(Clean, KeepsGoodData) {
  const CleaningResult result = clean(goodSamples(), {});
  EXPECT_EQ(result.status, CleaningResult::Status::kOk);
  EXPECT_GE(result.counts[Fate::kKept], 398u);
  EXPECT_EQ(result.counts.total(), 400u);
}

TEST(Clean, EachLimitRejectsWhatBreaksItAndSaysSo) {
  std::vector<CleaningSample> samples = goodSamples();
  samples[10].step = 0.2;
  samples[20].observation.q = samples[20].observation.q * expRotation({0.0, 2.0, 0.0});
  samples[30].observation.p.x() += 1.0;
  samples[45].twist.v = {0.5, 0.0, 0.0};
  samples[55].twist.w = {0.0, 7.0, 0.0};
  samples[65].command.p.y() += 0.03;
  const CleaningResult result = clean(samples, {});
  EXPECT_EQ(result.fates[10], Fate::kLongStep);
  EXPECT_EQ(result.fates[20], Fate::kRotationWindow);
  EXPECT_EQ(result.fates[30], Fate::kWorkspace);
  EXPECT_EQ(result.fates[45], Fate::kSpeed);
  EXPECT_EQ(result.fates[55], Fate::kAngularSpeed);
  EXPECT_EQ(result.fates[65], Fate::kLeastMedian);
}

TEST(Clean, ATrajectoryWithMoreThanNinetyPercentRejectedGoesWhole) {
  std::vector<CleaningSample> samples = goodSamples();
  for (std::size_t i = 0; i < 37; ++i) samples[i].twist.v.x() = 1.0;   // 37 of 40: above 90 %
  for (std::size_t i = 40; i < 76; ++i) samples[i].twist.v.x() = 1.0;  // 36 of 40: just 90 %
  const CleaningResult result = clean(samples, {});
  EXPECT_EQ(result.fates[39], Fate::kTrajectoryRejected);
  EXPECT_EQ(result.counts[Fate::kTrajectoryRejected], 3u);
  EXPECT_EQ(result.fates[79], Fate::kKept);
}

TEST(Clean, SaysWhenNothingIsLeft) {
  std::vector<CleaningSample> samples = goodSamples();
  for (CleaningSample& sample : samples) sample.twist.v.x() = 1.0;
  EXPECT_EQ(clean(samples, {}).status, CleaningResult::Status::kNothingLeft);
  CleaningOptions options;
  options.limits.speed = std::nan("");
  EXPECT_THROW(clean(samples, options), InvalidInput);
}

}  // namespace
}  // namespace raven_correction
