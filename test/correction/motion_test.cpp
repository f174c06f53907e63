// SPDX-License-Identifier: BSD-3-Clause
#include "raven_correction/correction/motion.h"

#include <gtest/gtest.h>

#include "raven_correction/error.h"
#include "raven_correction/geometry/differentiation.h"
#include "support/random_poses.h"

namespace raven_correction {
namespace {

using Outcome = MotionEstimator::Outcome;

StampedPose at(double t) {
  return {t, {{0.1 * t, -0.05 * t, 0.02 * t}, expRotation({0.0, 0.6 * t, 0.0})}};
}

TEST(MotionEstimator, PastIntervalsAreExactOnConstantTwist) {
  MotionOptions options;
  options.velocity = VelocityKind::kPast;
  options.intervals = {0.05, 0.15, 0.4};
  MotionEstimator estimator(options);
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> step(0.005, 0.03);
  double t = 10.0;
  for (int i = 0; i < 100; ++i) {
    ASSERT_EQ(estimator.push(t, at(t).pose), Outcome::kAccepted);
    if (t > 10.41)
      for (std::size_t k = 0; k < 3; ++k) {
        EXPECT_LT((estimator.motion().twists[k].v - Eigen::Vector3d(0.1, -0.05, 0.02)).norm(),
                  1e-11);
        EXPECT_LT((estimator.motion().twists[k].w - Eigen::Vector3d(0.0, 0.6, 0.0)).norm(), 1e-11);
      }
    t += step(random);
  }
}

TEST(MotionEstimator, BeforeItsFirstSampleAMotionWasAtRest) {
  MotionOptions options;
  options.intervals = {0.1, 0.3};
  MotionEstimator estimator(options);
  estimator.push(5.0, at(0.0).pose);
  EXPECT_EQ(estimator.motion().twists[0].v.norm(), 0.0);
  estimator.push(5.05, at(0.05).pose);
  // 0.05 s of motion in an interval of 0.1 s: half the speed; nothing in the interval before.
  EXPECT_NEAR(estimator.motion().twists[0].v.x(), 0.05, 1e-12);
  EXPECT_NEAR(estimator.motion().twists[1].v.norm(), 0.0, 1e-12);
}

TEST(MotionEstimator, AGapStartsANewMotion) {
  MotionEstimator estimator({});
  for (double t = 1.0; t < 2.0; t += 0.02) estimator.push(t, at(t).pose);
  EXPECT_GT(estimator.motion().twists[0].v.norm(), 0.05);
  estimator.push(2.5, at(2.5).pose);
  EXPECT_EQ(estimator.motion().twists[0].v.norm(), 0.0);
}

TEST(MotionEstimator, RefusesWhatIsNotAPoseOrNotNewAndChangesNothing) {
  MotionEstimator estimator({});
  estimator.push(1.0, at(1.0).pose);
  estimator.push(1.02, at(1.02).pose);
  const Eigen::Vector3d before = estimator.motion().twists[0].v;
  Pose broken = at(1.03).pose;
  broken.p.z() = std::nan("");
  EXPECT_EQ(estimator.push(1.03, broken), Outcome::kNotFinite);
  EXPECT_EQ(estimator.push(std::nan(""), at(1.0).pose), Outcome::kNotFinite);
  broken = at(1.03).pose;
  broken.q.coeffs() *= 0.9;
  EXPECT_EQ(estimator.push(1.03, broken), Outcome::kNotUnit);
  EXPECT_EQ(estimator.push(1.01, at(1.01).pose), Outcome::kBackwards);
  EXPECT_EQ(estimator.push(1.02, at(9.0).pose), Outcome::kRepeated);
  EXPECT_EQ(estimator.motion().twists[0].v, before);
}

TEST(MotionEstimator, ASampleThatIsTakenBackLeavesNoTrace) {
  std::mt19937_64 random(4);
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  for (const VelocityKind kind :
       {VelocityKind::kNone, VelocityKind::kCausal, VelocityKind::kPast}) {
    MotionOptions options;
    options.velocity = kind;
    options.window = 0.4;
    MotionEstimator disturbed(options), undisturbed(options);
    double t = 1.0;
    for (int i = 0; i < 6000; ++i) {  // several times what is remembered
      // Bursts, ordinary steps and gaps; the first sample of all is taken back, too.
      const double kind_of_step = uniform(random);
      t += kind_of_step < 0.3 ? 1e-5 : kind_of_step < 0.998 ? 1e-3 : 0.5;
      if (i == 0 || uniform(random) < 0.3) {
        disturbed.push(t + uniform(random), {randomVector(random, 1.0), at(t).pose.q});
        disturbed.undo();
      }
      ASSERT_EQ(disturbed.push(t, at(t).pose), Outcome::kAccepted) << i;
      undisturbed.push(t, at(t).pose);
      ASSERT_EQ(disturbed.motion().pose.p, undisturbed.motion().pose.p);
      ASSERT_EQ(disturbed.motion().step, undisturbed.motion().step);
      for (std::size_t k = 0; k < twistCount(options); ++k) {
        ASSERT_EQ(disturbed.motion().twists[k].v, undisturbed.motion().twists[k].v) << i;
        ASSERT_EQ(disturbed.motion().twists[k].w, undisturbed.motion().twists[k].w) << i;
      }
    }
  }
}

TEST(MotionEstimator, OneThatTakesOverKnowsWhatTheOtherKnew) {
  for (const VelocityKind kind : {VelocityKind::kCausal, VelocityKind::kPast}) {
    MotionOptions other_options;
    other_options.velocity = VelocityKind::kNone;
    other_options.window = 1.0;
    other_options.max_gap = 10.0;
    MotionOptions options;
    options.velocity = kind;
    for (const bool gap : {false, true}) {
      MotionEstimator other(other_options), late(options), all_along(options);
      double t = 1.0;
      for (int i = 0; i < 300; ++i, t += 0.004) {
        if (gap && i == 280) t += 1.0;  // longer than max_gap
        other.push(t, at(t).pose);
        all_along.push(t, at(t).pose);
      }
      late.takeOver(other);
      EXPECT_EQ(late.push(t - 0.01, at(t).pose), Outcome::kBackwards);
      late.push(t, at(t).pose);
      all_along.push(t, at(t).pose);
      EXPECT_GT(all_along.motion().twists[0].v.norm(), 0.05);
      EXPECT_EQ(late.motion().step, all_along.motion().step);
      for (std::size_t k = 0; k < twistCount(options); ++k) {
        EXPECT_EQ(late.motion().twists[k].v, all_along.motion().twists[k].v) << k;
        EXPECT_EQ(late.motion().twists[k].w, all_along.motion().twists[k].w) << k;
      }
    }
  }
}

TEST(MotionEstimator, ABurstDoesNotShortenItsMemory) {
  // At 20 kHz, 0.4 s are 8000 samples, many more than are remembered.
  MotionOptions options;
  options.intervals = {0.05, 0.4};
  MotionEstimator estimator(options);
  for (int i = 0; i <= 20000; ++i) estimator.push(1.0 + 5e-5 * i, at(1.0 + 5e-5 * i).pose);
  EXPECT_NEAR(estimator.motion().twists[1].v.x(), 0.1, 1e-9);
}

TEST(MotionsOf, CentralIsTheFivePointStencilWithinEachMotion) {
  PoseStream stream;
  for (int i = 0; i < 10; ++i) stream.push_back(at(0.02 * i));
  for (int i = 0; i < 10; ++i) stream.push_back({1.0 + 0.02 * i, at(-0.02 * i).pose});
  MotionOptions options;
  options.velocity = VelocityKind::kCentral;
  const std::vector<Motion> motions = motionsOf(stream, options);
  EXPECT_NEAR(motions[9].twists[0].v.x(), 0.1, 1e-11);  // not disturbed by the jump that follows
  EXPECT_NEAR(motions[10].twists[0].v.x(), -0.1, 1e-11);
}

TEST(MotionOptions, AreChecked) {
  MotionOptions options;
  options.intervals = {0.1, 0.05};
  EXPECT_THROW(checkMotionOptions(options), InvalidInput);
  options.intervals = {0.1, 0.2, 0.3, 0.4, 0.5};
  EXPECT_THROW(checkMotionOptions(options), InvalidInput);
  EXPECT_THROW(velocityFromName("fast"), InvalidInput);
}

}  // namespace
}  // namespace raven_correction
