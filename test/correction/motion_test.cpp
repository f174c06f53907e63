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

MotionOptions withPlay() {
  MotionOptions options;
  options.play_length = 0.02;
  options.play_angle = 0.3;
  return options;
}

/// Moves evenly in 0.2 s by `distance` along x and by `angle` about z.
void moveBy(double distance, double angle, double& stamp, Pose& pose, MotionEstimator& estimator) {
  const Pose from = pose;
  for (int i = 1; i <= 10; ++i) {
    pose.p = from.p + Eigen::Vector3d(0.1 * i * distance, 0.0, 0.0);
    pose.q = expRotation({0.0, 0.0, 0.1 * i * angle}) * from.q;
    stamp += 0.02;
    ASSERT_EQ(estimator.push(stamp, pose), Outcome::kAccepted);
  }
}

TEST(MotionEstimator, PlayRemembersAtRestWhereTheToolHasComeFrom) {
  MotionEstimator estimator(withPlay());
  double stamp = 1.0;
  Pose pose{{0.1, 0.2, 0.3}, expRotation({0.3, -0.8, 0.2})};
  estimator.push(stamp, pose);
  EXPECT_EQ(estimator.motion().play.p.norm(), 0.0);
  const auto expectPlay = [&](double x, double rz) {
    EXPECT_LT((estimator.motion().play.p - Eigen::Vector3d(x, 0.0, 0.0)).norm(), 1e-12);
    EXPECT_LT((estimator.motion().play.r - Eigen::Vector3d(0.0, 0.0, rz)).norm(), 1e-12);
  };
  moveBy(0.015, 0.2, stamp, pose, estimator);  // within the play
  expectPlay(0.015, 0.2);
  moveBy(0.05, 0.5, stamp, pose, estimator);  // and far beyond it
  expectPlay(0.02, 0.3);
  moveBy(0.0, 0.0, stamp, pose, estimator);  // rest, to which the velocities do not know the way
  EXPECT_EQ(estimator.motion().twists[0].v.norm(), 0.0);
  expectPlay(0.02, 0.3);
  stamp += 100.0;  // a pause between two motions
  moveBy(0.0, 0.0, stamp, pose, estimator);
  expectPlay(0.02, 0.3);
  moveBy(-0.025, -0.5, stamp, pose, estimator);  // back: the position in part, the rest in full
  expectPlay(-0.005, -0.2);
}

TEST(MotionEstimator, PlayTakesAMoveThatNobodySawForAStraightOne) {
  MotionEstimator seen(withPlay()), unseen(withPlay());
  Pose pose{{0.1, 0.2, 0.3}, Eigen::Quaterniond::Identity()};
  double stamp = 1.0;
  seen.push(stamp, pose);
  unseen.push(stamp, pose);
  moveBy(0.1, 0.8, stamp, pose, seen);
  unseen.push(stamp, pose);
  EXPECT_LT((seen.motion().play.p - unseen.motion().play.p).norm(), 1e-12);
  EXPECT_LT((seen.motion().play.r - unseen.motion().play.r).norm(), 1e-12);
}

TEST(MotionEstimator, PlayGoesOnWithANewMotionAndIsForgottenByAReset) {
  MotionEstimator estimator(withPlay());
  double stamp = 50.0;
  Pose pose;
  moveBy(0.05, 0.5, stamp, pose, estimator);
  estimator.startMotion();
  ASSERT_EQ(estimator.push(1.0, pose), Outcome::kAccepted) << "stamps of another motion may be any";
  EXPECT_NEAR(estimator.motion().play.p.x(), 0.02, 1e-12);
  EXPECT_EQ(estimator.motion().twists[0].v.norm(), 0.0);
  estimator.reset();
  estimator.push(0.5, pose);
  EXPECT_EQ(estimator.motion().play.p.norm(), 0.0);
  EXPECT_EQ(estimator.motion().play.r.norm(), 0.0);
}

TEST(MotionsOf, GoesOnWithWhatTheEstimatorKnows) {
  const MotionOptions options = withPlay();
  PoseStream first, second;
  for (int i = 0; i < 50; ++i) first.push_back(at(0.02 * i));
  for (int i = 0; i < 50; ++i) second.push_back({5.0 + 0.02 * i, at(1.0 - 0.001 * i).pose});
  MotionEstimator together(options), live(options);
  motionsOf(first, options, together);
  const std::vector<Motion> motions = motionsOf(second, options, together);
  for (const StampedPose& sample : first) live.push(sample.stamp, sample.pose);
  for (std::size_t i = 0; i < second.size(); ++i) {
    live.push(second[i].stamp, second[i].pose);
    EXPECT_EQ(live.motion().play.p, motions[i].play.p);
    EXPECT_EQ(live.motion().play.r, motions[i].play.r);
  }
  EXPECT_NE(motions[0].play.p, motionsOf(second, options)[0].play.p);
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
  options = {};
  options.play_length = 0.02;
  EXPECT_THROW(checkMotionOptions(options), InvalidInput) << "one without the other";
  options.play_angle = -0.1;
  EXPECT_THROW(checkMotionOptions(options), InvalidInput);
  options.play_angle = 0.3;
  EXPECT_NO_THROW(checkMotionOptions(options));
}

}  // namespace
}  // namespace raven_correction
