// SPDX-License-Identifier: BSD-3-Clause
#include "raven_correction/correction/corrector.h"

#include <gtest/gtest.h>

#include <array>
#include <atomic>
#include <limits>
#include <thread>

#include "raven_correction/error.h"
#include "robot/robots.h"
#include "support/allocation_guard.h"
#include "support/random_poses.h"
#include "support/simple_model.h"

namespace raven_correction {
namespace {

CorrectorLimits looseLimits() {
  CorrectorLimits limits;
  limits.max_translation_rate = 10.0;  // reaches any correction of these tests in one command
  limits.max_rotation_rate = 100.0;
  return limits;
}

bool same(const Pose& a, const Pose& b) { return a.p == b.p && a.q.coeffs() == b.q.coeffs(); }

/// A slow motion inside the trained region.
Pose inside(int i) { return {{1e-4 * i, 0.01, -0.01}, expRotation({0.02, 0.0, 1e-4 * i})}; }

double stampOf(int i) { return 100.0 + 0.02 * i; }

class CorrectorTest : public ::testing::Test {
 protected:
  CorrectorOutput send(Corrector& corrector, int i) {
    return corrector.correct(stampOf(i), stampOf(i), inside(i), false);
  }
  const Correction model_ = simpleModel();
};

TEST_F(CorrectorTest, WithoutAModelOrOffThePoseIsUnchangedBitForBit) {
  Corrector corrector(looseLimits());
  EXPECT_EQ(send(corrector, 0).code, CorrectorCode::kPassedOff);
  corrector.setMode(CorrectorMode::kFull);
  CorrectorOutput output = send(corrector, 1);
  EXPECT_EQ(output.code, CorrectorCode::kPassedNoModel);
  EXPECT_TRUE(same(output.command, inside(1)));
  corrector.setModel(model_);
  corrector.setMode(CorrectorMode::kOff);
  output = send(corrector, 2);
  EXPECT_EQ(output.code, CorrectorCode::kPassedOff);
  EXPECT_TRUE(same(output.command, inside(2)));
}

TEST_F(CorrectorTest, TheFullCorrectionIsThatOfThePredictor) {
  Corrector corrector(looseLimits());
  corrector.setModel(model_);
  corrector.setMode(CorrectorMode::kFull);
  const Predictor predictor(model_);
  const auto workspace = predictor.makeWorkspace();
  MotionEstimator estimator(model_.motion);
  for (int i = 0; i < 20; ++i) {
    const CorrectorOutput output = send(corrector, i);
    estimator.push(stampOf(i), inside(i));
    const Prediction expected = predictor.predict(estimator.motion(), *workspace);
    EXPECT_EQ(output.code, CorrectorCode::kCorrected);
    EXPECT_LT((output.command.p - expected.command.p).norm(), 1e-12);
    EXPECT_LT(rotationAngle(output.command.q, expected.command.q), 1e-12);
    EXPECT_EQ(*output.model, "simple");
    EXPECT_GT(output.sd_position.minCoeff(), 0.0);
  }
}

TEST_F(CorrectorTest, AModelOfAnyKindIsWhatThePredictorMakesOfIt) {
  const auto desired = [](int i) {
    return Pose{{-0.02 + 1e-4 * i, -0.06, -0.14}, {0.5, -0.5, 0.5, 0.5}};
  };
  for (const bool physics : {false, true}) {
    for (const bool process : {false, true}) {
      Correction model = model_;
      model.trust.workspace_min.setConstant(-1.0);
      model.trust.workspace_max.setConstant(1.0);
      if (!process) model.process = {};
      if (physics) {
        model.physics.texts =
            simulationTexts(loadSimulationConfig("config/simulation/raven2_left_case2014.yaml"));
        model.physics.timing = {model.delay, 0.01, 100.0};
      }
      CorrectorLimits limits = looseLimits();
      limits.max_translation = 0.2;
      limits.max_rotation = 3.0;
      Corrector corrector(limits);
      corrector.setModel(model);
      corrector.setMode(CorrectorMode::kFull);
      const Predictor predictor(model);
      const auto workspace = predictor.makeWorkspace();
      MotionEstimator estimator(model.motion);
      for (int i = 0; i < 40; ++i) {
        const CorrectorOutput output = corrector.correct(stampOf(i), stampOf(i), desired(i), false);
        estimator.push(stampOf(i), desired(i));
        const Prediction expected = predictor.predict(estimator.motion(), *workspace);
        ASSERT_LT((output.command.p - expected.command.p).norm(), 1e-12) << physics << process;
        ASSERT_LT(rotationAngle(output.command.q, expected.command.q), 1e-12);
        if (physics) {
          ASSERT_GT((output.command.p - expected.rigid.p).norm(), 1e-3);
        }
        if (!process) {
          EXPECT_EQ(output.code, physics ? CorrectorCode::kCorrected : CorrectorCode::kRigidOnly);
          EXPECT_EQ(output.h_share, 0.0);
        }
      }
    }
  }
}

TEST_F(CorrectorTest, RigidModeIsTheRigidStepAlone) {
  Corrector corrector(looseLimits());
  corrector.setModel(model_);
  corrector.setMode(CorrectorMode::kRigid);
  const CorrectorOutput output = send(corrector, 0);
  EXPECT_EQ(output.code, CorrectorCode::kRigidOnly);
  EXPECT_LT((output.command.p - (model_.rigid * inside(0)).p).norm(), 1e-12);
}

TEST_F(CorrectorTest, EndpointModeCorrectsEndpointsOnly) {
  Corrector corrector(looseLimits());
  corrector.setModel(model_);
  corrector.setMode(CorrectorMode::kEndpoint);
  EXPECT_EQ(corrector.correct(1.0, 1.0, inside(0), true).code, CorrectorCode::kCorrected);
  const CorrectorOutput between = corrector.correct(1.02, 1.02, inside(1), false);
  EXPECT_EQ(between.code, CorrectorCode::kPassedBetweenEndpoints);
  EXPECT_TRUE(same(between.command, inside(1)));
}

TEST_F(CorrectorTest, EveryBadInputIsRefusedWithItsCodeAndChangesNothing) {
  Corrector corrector(looseLimits());
  corrector.setModel(model_);
  corrector.setMode(CorrectorMode::kFull);
  for (int i = 0; i < 10; ++i) send(corrector, i);
  const double t = stampOf(10);
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  const auto code = [&](double stamp, double now, const Pose& pose) {
    return corrector.correct(stamp, now, pose, false).code;
  };
  Pose bad = inside(10);
  bad.p.x() = kNan;
  EXPECT_EQ(code(t, t, bad), CorrectorCode::kRefusedNotFinite);
  bad = inside(10);
  bad.q.w() = std::numeric_limits<double>::infinity();
  EXPECT_EQ(code(t, t, bad), CorrectorCode::kRefusedNotFinite);
  EXPECT_EQ(code(kNan, t, inside(10)), CorrectorCode::kRefusedNotFinite);
  bad = inside(10);
  bad.q.coeffs() *= 1.01;
  EXPECT_EQ(code(t, t, bad), CorrectorCode::kRefusedNotUnit);
  EXPECT_EQ(code(0.0, t, inside(10)), CorrectorCode::kRefusedZeroStamp);
  EXPECT_EQ(code(t, t + 0.51, inside(10)), CorrectorCode::kRefusedStale);
  EXPECT_EQ(code(t, t - 0.51, inside(10)), CorrectorCode::kRefusedFuture);
  EXPECT_EQ(code(t, kNan, inside(10)), CorrectorCode::kRefusedStale);
  EXPECT_EQ(code(stampOf(9), t, inside(10)), CorrectorCode::kRefusedTimeBackwards);
  EXPECT_EQ(code(stampOf(5), t, inside(10)), CorrectorCode::kRefusedTimeBackwards);

  Corrector undisturbed(looseLimits());
  undisturbed.setModel(model_);
  undisturbed.setMode(CorrectorMode::kFull);
  for (int i = 0; i < 10; ++i) send(undisturbed, i);
  EXPECT_TRUE(same(send(corrector, 10).command, send(undisturbed, 10).command));
}

TEST_F(CorrectorTest, ANewModelKnowsTheMotionSoFar) {
  Correction first = simpleModel(VelocityKind::kPast), again = first;
  again.id = "the same under another name";
  const auto moving = [](int i) {  // 50 mm/s: the velocity counts
    return Pose{{-0.04 + 1e-3 * i, 0.01, -0.01}, expRotation({0.02, 0.0, 1e-3 * i})};
  };
  Corrector swapped(looseLimits()), late(looseLimits()), undisturbed(looseLimits());
  swapped.setModel(first);
  undisturbed.setModel(first);
  for (Corrector* const corrector : {&swapped, &late, &undisturbed})
    corrector->setMode(CorrectorMode::kFull);
  for (int i = 0; i < 60; ++i) {
    if (i == 30) swapped.setModel(again);
    if (i == 35) swapped.setModel(again);  // sent again
    if (i == 30) late.setModel(first);
    const Pose expected = undisturbed.correct(stampOf(i), stampOf(i), moving(i), false).command;
    const CorrectorOutput output = swapped.correct(stampOf(i), stampOf(i), moving(i), false);
    ASSERT_TRUE(same(output.command, expected)) << i;
    ASSERT_EQ(*output.model, i < 30 ? first.id : again.id);
    const Pose after = late.correct(stampOf(i), stampOf(i), moving(i), false).command;
    if (i >= 30) {
      ASSERT_LT((after.p - expected.p).norm(), 1e-12) << i;
    }
  }
  // It would have mattered: one that knows nothing of the motion so far answers something else.
  Corrector ignorant(looseLimits());
  ignorant.setModel(first);
  ignorant.setMode(CorrectorMode::kFull);
  const Pose alone = ignorant.correct(stampOf(60), stampOf(60), moving(60), false).command;
  const Pose expected = undisturbed.correct(stampOf(60), stampOf(60), moving(60), false).command;
  EXPECT_GT((alone.p - expected.p).norm(), 1e-5);
}

TEST_F(CorrectorTest, WhatIsPreparedAndNotSentChangesNothing) {
  // With a limit about the last command, a hold, a silence and swaps: all that a pose may change.
  CorrectorLimits limits;
  limits.robot.max_step = 0.02;
  Correction other = model_;
  other.id = "other";
  other.rigid.p.y() += 0.02;
  Corrector disturbed(limits), undisturbed(limits);
  std::mt19937_64 random(5);
  double stamp = 100.0;
  for (int i = 0; i < 600; ++i) {
    for (Corrector* const corrector : {&disturbed, &undisturbed}) {
      if (i == 20) corrector->setMode(CorrectorMode::kFull);
      if (i == 50) corrector->setModel(model_);
      if (i == 300) corrector->setModel(other);
      if (i == 400) corrector->setHold(CorrectionHold::kOtherPublisher);
      if (i == 403) corrector->setHold(CorrectionHold::kNone);
      if (i == 550) corrector->restart();
    }
    stamp += i == 402 ? 0.3 : 0.005;
    for (int k = 0; k < 3; ++k) {
      const Pose unsent{inside(i).p + randomVector(random, 0.01), inside(i).q};
      disturbed.prepare(stamp + 0.01 * k, stamp, unsent, false);
    }
    const CorrectorOutput a = disturbed.correct(stamp, stamp, inside(i), false);
    const CorrectorOutput b = undisturbed.correct(stamp, stamp, inside(i), false);
    ASSERT_EQ(a.code, b.code) << i;
    ASSERT_TRUE(same(a.command, b.command)) << i;
    disturbed.commit();  // once is enough
  }
}

TEST_F(CorrectorTest, SizeIsLimitedAndSaysSo) {
  CorrectorLimits limits = looseLimits();
  limits.max_translation = 0.004;
  limits.max_rotation = 0.02;
  Corrector corrector(limits);
  corrector.setModel(model_);
  corrector.setMode(CorrectorMode::kFull);
  for (int i = 0; i < 5; ++i) {
    const CorrectorOutput output = send(corrector, i);
    EXPECT_EQ(output.code, CorrectorCode::kCorrectedLimited);
    EXPECT_LE((output.command.p - inside(i).p).norm(), 0.004 + 1e-12);
    EXPECT_LE(rotationAngle(output.command.q, inside(i).q), 0.02 + 1e-12);
  }
}

TEST_F(CorrectorTest, StepsAreLimitedThroughSwapsOfModelAndMode) {
  CorrectorLimits limits;
  limits.max_translation_rate = 0.1;
  limits.max_rotation_rate = 1.0;
  Corrector corrector(limits);
  Correction other = model_;
  other.id = "other";
  other.rigid.p.x() += 0.02;
  Pose last_desired = inside(0), last_command = last_desired;
  for (int i = 0; i < 400; ++i) {
    if (i == 20) corrector.setMode(CorrectorMode::kFull);
    if (i == 40) corrector.setModel(model_);
    if (i == 120) corrector.setModel(other);
    if (i == 200) corrector.setMode(CorrectorMode::kRigid);
    if (i == 260) corrector.setMode(CorrectorMode::kOff);
    const CorrectorOutput output = send(corrector, i);
    // The command moves with the desired pose, plus at most the rate times the interval. The first
    // pose of all may start with the step of max_step_time; here it is not corrected.
    const double own = (inside(i).p - last_desired.p).norm();
    EXPECT_LE((output.command.p - last_command.p).norm(), own + 0.1 * 0.02 + 1e-9) << i;
    EXPECT_LE(rotationAngle(output.command.q, last_command.q),
              rotationAngle(inside(i).q, last_desired.q) + 1.0 * 0.02 + 1e-9)
        << i;
    last_desired = inside(i);
    last_command = output.command;
  }
  EXPECT_TRUE(same(last_command, last_desired));  // off for long: unchanged again
}

TEST_F(CorrectorTest, ALongSilenceDoesNotAllowALargeStep) {
  CorrectorLimits limits;
  limits.max_translation_rate = 0.1;
  limits.max_step_time = 0.05;
  Corrector corrector(limits);
  send(corrector, 0);  // off
  corrector.setModel(model_);
  corrector.setMode(CorrectorMode::kFull);
  const CorrectorOutput output = corrector.correct(900.0, 900.0, inside(1), false);
  EXPECT_EQ(output.code, CorrectorCode::kCorrectedLimited);
  EXPECT_LE((output.command.p - inside(1).p).norm(), 0.1 * 0.05 + 1e-12);
}

TEST_F(CorrectorTest, WhereTheDataSayNothingTheGaussianProcessFadesToTheRigidStep) {
  Correction timid = model_;
  timid.trust.fade_start = 1e-6;  // of the prior deviation: every state is beyond that
  timid.trust.fade_end = 1e-5;
  Corrector corrector(looseLimits());
  corrector.setModel(timid);
  corrector.setMode(CorrectorMode::kFull);
  const CorrectorOutput output = send(corrector, 0);
  EXPECT_EQ(output.code, CorrectorCode::kCorrectedFaded);
  EXPECT_EQ(output.h_share, 0.0);
  EXPECT_LT((output.command.p - (model_.rigid * inside(0)).p).norm(), 1e-12);
}

TEST_F(CorrectorTest, OutsideTheWorkspaceThePoseIsUnchanged) {
  Corrector corrector(looseLimits());
  corrector.setModel(model_);
  corrector.setMode(CorrectorMode::kFull);
  const Pose far{{0.5, 0.0, 0.0}, expRotation({0.0, 0.0, 0.0})};
  const CorrectorOutput output = corrector.correct(1.2, 1.2, far, false);
  EXPECT_EQ(output.code, CorrectorCode::kPassedOutside);
  EXPECT_TRUE(same(output.command, far));
}

TEST_F(CorrectorTest, TheCommandStaysInTheBox) {
  CorrectorLimits limits = looseLimits();
  limits.box_min = {-0.05, -0.05, -0.05};
  limits.box_max = {0.005, 0.05, 0.05};
  Corrector corrector(limits);
  corrector.setModel(model_);
  corrector.setMode(CorrectorMode::kFull);
  const CorrectorOutput output = send(corrector, 0);
  EXPECT_EQ(output.code, CorrectorCode::kCorrectedLimited);
  EXPECT_LE(output.command.p.x(), 0.005 + 1e-12);
}

TEST_F(CorrectorTest, TheBoxDoesNotMakeTheCommandJumpWhereThePlannerItselfLeavesIt) {
  CorrectorLimits limits;
  limits.box_min = {-0.05, -0.05, -0.05};
  limits.box_max = {0.002, 0.05, 0.05};
  Corrector corrector(limits);
  corrector.setModel(model_);
  Pose last = inside(0);
  for (int i = 0; i < 300; ++i) {  // x runs from 0 to 30 mm, through the side of the box at 2 mm
    if (i == 10) corrector.setMode(CorrectorMode::kFull);
    if (i == 200) corrector.setMode(CorrectorMode::kOff);
    const CorrectorOutput output = send(corrector, i);
    if (i > 0) {
      EXPECT_LE((output.command.p - last.p).norm(), 1e-4 + 0.15 * 0.02 + 1e-9) << i;
    }
    EXPECT_LE(output.command.p.x(), std::max(0.002, inside(i).p.x()) + 1e-12) << i;
    last = output.command;
  }
  limits.box_max.x() = -0.06;
  EXPECT_THROW(Corrector{limits}, InvalidInput);
}

TEST_F(CorrectorTest, AHoldTakesTheCorrectionBackInSteps) {
  CorrectorLimits limits;
  limits.max_translation_rate = 0.1;
  Corrector corrector(limits);
  corrector.setModel(model_);
  corrector.setMode(CorrectorMode::kFull);
  for (int i = 0; i < 50; ++i) send(corrector, i);
  corrector.setHold(CorrectionHold::kRobotNotReady);
  Eigen::Vector3d last = send(corrector, 50).command.p - inside(50).p;
  EXPECT_GT(last.norm(), 0.005);
  for (int i = 51; i < 150; ++i) {
    const Eigen::Vector3d now = send(corrector, i).command.p - inside(i).p;
    EXPECT_LE((now - last).norm(), 0.1 * 0.02 + 1e-12);
    last = now;
  }
  const CorrectorOutput output = send(corrector, 150);
  EXPECT_EQ(output.code, CorrectorCode::kPassedRobotNotReady);
  EXPECT_TRUE(same(output.command, inside(150)));
  corrector.setHold(CorrectionHold::kOtherPublisher);
  EXPECT_EQ(send(corrector, 151).code, CorrectorCode::kPassedOtherPublisher);
  corrector.setMode(CorrectorMode::kOff);
  EXPECT_EQ(send(corrector, 152).code, CorrectorCode::kPassedOff);
}

/// The size of the correction of a pose that comes after a silence in which a hold began and ended.
double afterHoldInSilence(const Correction& model, double silence, bool forgotten) {
  Corrector corrector{CorrectorLimits()};
  corrector.setModel(model);
  corrector.setMode(CorrectorMode::kFull);
  double stamp = 100.0;
  for (int i = 0; i < 100; ++i, stamp += 0.02) corrector.correct(stamp, stamp, inside(0), false);
  corrector.setHold(CorrectionHold::kRobotNotReady);
  if (forgotten) corrector.restart();
  corrector.setHold(CorrectionHold::kNone);
  stamp += silence - 0.02;
  return (corrector.correct(stamp, stamp, inside(0), false).command.p - inside(0).p).norm();
}

TEST_F(CorrectorTest, AHoldThatBeginsAndEndsInASilenceTakesTheCorrectionBack) {
  const CorrectorLimits limits;
  const double step = limits.max_translation_rate * limits.max_step_time;
  Correction large = model_;
  large.rigid.p.x() = 0.05;
  const double full = afterHoldInSilence(large, 0.02, false);
  EXPECT_GT(full, 0.045);
  // An emergency stop and a homing: nothing is known of the tool, the correction comes in anew.
  EXPECT_LE(afterHoldInSilence(large, 30.0, false), step + 1e-12);
  EXPECT_LE(afterHoldInSilence(large, 0.02, true), step + 1e-12) << "the clock jumped back, too";
  // One that lasts no longer than the pause of a slow planner does not make the command jump.
  EXPECT_GT(afterHoldInSilence(large, 0.2, false), full - step);
}

TEST_F(CorrectorTest, AHoldThatOutlastsAPoseCountsInTheSilenceAfterIt) {
  Corrector corrector{CorrectorLimits()};
  corrector.setModel(model_);
  corrector.setMode(CorrectorMode::kFull);
  for (int i = 0; i < 100; ++i) send(corrector, i);
  corrector.setHold(CorrectionHold::kOtherPublisher);
  send(corrector, 100);
  corrector.setHold(CorrectionHold::kNone);
  const CorrectorLimits limits;
  const Pose desired = inside(0);
  EXPECT_LE((corrector.correct(900.0, 900.0, desired, false).command.p - desired.p).norm(),
            limits.max_translation_rate * limits.max_step_time + 1e-12);
}

TEST_F(CorrectorTest, TheGainIsAShareOfTheCorrection) {
  Corrector corrector(looseLimits());
  corrector.setModel(model_);
  corrector.setMode(CorrectorMode::kRigid);
  const Eigen::Vector3d full = send(corrector, 0).command.p - inside(0).p;
  corrector.setTuning(0.25, 0.06, 0.8);
  const CorrectorOutput output = send(corrector, 1);
  const Pose quarter = output.command;
  EXPECT_EQ(output.gain, 0.25);
  EXPECT_EQ(output.mode, CorrectorMode::kRigid);
  const Eigen::Vector3d wanted = 0.25 * ((model_.rigid * inside(1)).p - inside(1).p);
  EXPECT_LT((quarter.p - inside(1).p - wanted).norm(), 1e-12);
  EXPECT_GT(full.norm(), 0.01);
  corrector.setTuning(0.0, 0.06, 0.8);
  EXPECT_TRUE(same(send(corrector, 2).command, inside(2)));
  EXPECT_THROW(corrector.setTuning(1.1, 0.06, 0.8), InvalidInput);
  EXPECT_THROW(corrector.setTuning(std::nan(""), 0.06, 0.8), InvalidInput);
  EXPECT_THROW(corrector.setTuning(1.0, 0.0, 0.8), InvalidInput);
}

TEST_F(CorrectorTest, AForwardedIncrementMakesOlderOnesStale) {
  Corrector corrector(looseLimits());
  send(corrector, 0);
  EXPECT_FALSE(corrector.fault(stampOf(1), stampOf(1), inside(1)).has_value());
  const CorrectorOutput output =
      corrector.prepareParts(stampOf(1), stampOf(1), inside(1), false, false);
  EXPECT_EQ(output.code, CorrectorCode::kPassedNotAbsolute);
  EXPECT_TRUE(same(output.command, inside(1)));
  EXPECT_FALSE(corrector.fault(stampOf(1), stampOf(1), inside(1)).has_value()) << "not sent yet";
  corrector.commit();
  EXPECT_EQ(corrector.fault(stampOf(1), stampOf(1), inside(1)),
            CorrectorCode::kRefusedTimeBackwards);
  EXPECT_EQ(send(corrector, 1).code, CorrectorCode::kRefusedTimeBackwards);
  EXPECT_EQ(send(corrector, 2).code, CorrectorCode::kPassedOff);
}

// A controller that adds increments to what it was sent, and a planner that believes it was sent
// what it asked for: the difference of the two is the correction, and moves at its limited rate
// whatever the planner sends.
TEST_F(CorrectorTest, IncrementsAndPartsNeverMakeTheCorrectionJump) {
  const CorrectorLimits limits;
  Corrector corrector(limits);
  corrector.setModel(model_);
  corrector.setMode(CorrectorMode::kFull);
  std::mt19937_64 random(11);
  constexpr double kPeriod = 0.005;
  Pose believed = inside(0), controlled = believed;
  int jumps_possible = 0, unchanged = 0;
  int kind = 0;
  double stamp = 100.0;
  for (int i = 0; i < 6000; ++i, stamp += kPeriod) {
    if (i % 100 == 0) kind = static_cast<int>(random() % 5);
    const Eigen::Vector3d before = controlled.p - believed.p;
    const Eigen::Quaterniond turned_before = believed.q.conjugate() * controlled.q;
    const Pose step{randomVector(random, 1e-4), expRotation(randomVector(random, 1e-3))};
    Pose next{believed.p + step.p, (step.q * believed.q).normalized()};
    if (i % 100 == 0 && kind == 0) next = inside(0);               // and planners jump
    const bool position = kind == 0 || kind == 1 || kind == 2;     // absolute
    const bool orientation = kind == 0 || kind == 1 || kind == 3;  // absolute
    if (position && orientation) {
      controlled = corrector.correct(stamp, stamp, next, false).command;
    } else {
      const Pose sent{position ? next.p : step.p, orientation ? next.q : step.q};
      const CorrectorOutput output =
          corrector.prepareParts(stamp, stamp, sent, position, orientation);
      corrector.commit();
      if (!position) {
        ASSERT_EQ(output.command.p, step.p);
      }
      if (!orientation) {
        ASSERT_EQ(output.command.q.coeffs(), step.q.coeffs());
      }
      unchanged += same(output.command, sent);
      controlled.p = position ? output.command.p : Eigen::Vector3d(controlled.p + step.p);
      controlled.q = orientation ? output.command.q : (step.q * controlled.q).normalized();
    }
    believed = next;
    const Eigen::Quaterniond turned = believed.q.conjugate() * controlled.q;
    ASSERT_LE((controlled.p - believed.p - before).norm(),
              limits.max_translation_rate * kPeriod + 1e-9)
        << i << " kind " << kind;
    ASSERT_LE(rotationAngle(turned_before, turned), limits.max_rotation_rate * kPeriod + 1e-7) << i;
    jumps_possible += before.norm() > 0.01;
  }
  EXPECT_GT(jumps_possible, 1000);
  EXPECT_GT(unchanged, 1000);
}

TEST_F(CorrectorTest, TheDistanceIsThatFromTheBoxOfTheTraining) {
  Corrector corrector(looseLimits());
  corrector.setModel(model_);
  corrector.setMode(CorrectorMode::kFull);
  EXPECT_EQ(send(corrector, 0).distance, 0.0);
  const Pose far{{0.08, 0.09, 0.0}, inside(0).q};
  EXPECT_NEAR(corrector.correct(101.0, 101.0, far, false).distance, 0.05, 1e-12);
}

TEST_F(CorrectorTest, WithoutAMeasuredPoseTheLastCommandIsWhereTheToolIs) {
  CorrectorLimits limits = looseLimits();
  limits.robot.max_step = 0.004;
  Corrector corrector(limits);
  send(corrector, 0);  // off: the tool is where the planner wants it
  corrector.setModel(model_);
  corrector.setMode(CorrectorMode::kFull);
  const CorrectorOutput output = send(corrector, 1);
  EXPECT_NEAR((output.command.p - inside(0).p).norm(), 0.004, 1e-9);
  EXPECT_TRUE(output.limits & kLimitRobotStep);
  EXPECT_EQ(output.tool_known_by, ToolKnownBy::kLastCommand);
}

TEST_F(CorrectorTest, AMeasuredPoseCountsForAsLongAsItsStampIsNearTheClock) {
  CorrectorLimits limits = looseLimits();
  limits.robot.max_step = 0.004;
  limits.max_measured_age = 0.1;
  Corrector corrector(limits);
  corrector.setModel(model_);
  corrector.setMode(CorrectorMode::kFull);
  Pose tool = inside(0);
  tool.p.x() -= 0.003;
  const auto isTool = [&](const CorrectorOutput& output) {
    return output.tool_known_by == ToolKnownBy::kMeasured &&
           std::abs((output.command.p - tool.p).norm() - 0.004) < 1e-9;
  };
  EXPECT_EQ(send(corrector, 0).tool_known_by, ToolKnownBy::kNothing);
  corrector.setMeasured(stampOf(1), stampOf(1), tool);
  EXPECT_TRUE(isTool(send(corrector, 1)));
  // What is no pose, has no stamp, is ahead of the clock or older than the last one changes
  // nothing.
  Pose other = inside(0), broken = tool;
  other.p.x() += 0.02;
  broken.p.x() = std::nan("");
  corrector.setMeasured(stampOf(2), stampOf(2), broken);
  corrector.setMeasured(0.0, stampOf(2), other);
  corrector.setMeasured(std::nan(""), stampOf(2), other);
  corrector.setMeasured(stampOf(2) + 0.11, stampOf(2), other);
  corrector.setMeasured(stampOf(1), stampOf(2), other);
  corrector.setMeasured(stampOf(0), stampOf(2), other);
  EXPECT_TRUE(isTool(send(corrector, 2)));
  // A clock that is a little behind that of the robot is no reason to know nothing.
  corrector.setMeasured(stampOf(4), stampOf(3), tool);
  EXPECT_TRUE(isTool(send(corrector, 3)));
  // It ages by its stamp, not by when it came.
  EXPECT_TRUE(isTool(send(corrector, 8)));
  const Pose last = send(corrector, 9).command;
  const CorrectorOutput output = send(corrector, 10);  // 0.12 s
  EXPECT_EQ(output.tool_known_by, ToolKnownBy::kLastCommand);
  EXPECT_LE((output.command.p - last.p).norm(), 0.004 + 1e-9);
  corrector.setMeasured(stampOf(10), stampOf(16), tool);
  EXPECT_EQ(send(corrector, 16).tool_known_by, ToolKnownBy::kLastCommand);
}

// Every answer of a corrector with all its limits, a chain and a measured tool; only what the node
// itself answers (frames, latched publishers, other arms) is not among them.
TEST_F(CorrectorTest, NoAnswerAllocates) {
  const auto chain = std::make_shared<KinematicChain>(shippedRobot("raven2_left"));
  JointVector q = chain->home();
  const int insertion = chain->indexOf("insertion");
  q(insertion) = chain->lower()(insertion) + 0.03;
  const Pose home = chain->forward(q);
  q(insertion) -= 0.029;
  const Pose border = chain->forward(q);  // the correction leads out of reach from here
  q(insertion) -= 0.05;
  const Pose beyond = chain->forward(q);  // and here the planner is out of reach itself

  const Correction model =
      simpleModel(VelocityKind::kCausal, home,
                  {0.02 * (border.p - home.p).normalized(), Eigen::Quaterniond::Identity()});
  Correction overflowing = model, faded = model, rigid = model;
  overflowing.id = "overflowing";
  overflowing.process.groups[0].weights.setConstant(1e308);
  faded.id = "faded";
  faded.trust.fade_start = 1e-6;
  faded.trust.fade_end = 1e-5;
  rigid.id = "rigid";
  rigid.process = {};

  CorrectorLimits limits;
  limits.robot.chain = chain;
  limits.robot.max_step = 0.05;
  limits.robot.max_turn = 1.0;
  limits.box_min.setConstant(-0.5);
  limits.box_max.setConstant(0.5);
  Corrector corrector(limits);
  std::array<bool, 32> seen{};
  int allocations = 0;
  double stamp = 100.0;
  // @param at  stamp relative to the clock [s]
  const auto answer = [&](const Pose& desired, double at = 0.0, bool endpoint = false) {
    const AllocationGuard guard;
    stamp += 0.05;
    corrector.setMeasured(stamp, stamp, home);
    const CorrectorOutput output = corrector.correct(stamp + at, stamp, desired, endpoint);
    seen[static_cast<std::size_t>(output.code)] = true;
    allocations += guard.count();
  };
  const auto answers = [&](const Pose& desired) {
    for (int i = 0; i < 40; ++i) answer(desired);
  };
  answer(home);  // off
  corrector.setMode(CorrectorMode::kFull);
  answer(home);  // no model
  for (const Correction* const next : {&overflowing, &faded, &rigid, &model}) {
    corrector.setModel(*next);
    answers(home);
    corrector.setMode(CorrectorMode::kOff);
    answers(home);
    corrector.setMode(CorrectorMode::kFull);
    answers(home);
  }
  answer(border);  // unreachable at first, then limited
  answers(border);
  answers(beyond);
  answers({home.p + Eigen::Vector3d(0.3, 0.0, 0.0), home.q});  // outside
  answers({home.p + Eigen::Vector3d(0.12, 0.0, 0.0), home.q});
  for (const CorrectionHold hold :
       {CorrectionHold::kRobotNotReady, CorrectionHold::kOtherPublisher, CorrectionHold::kNone}) {
    corrector.setHold(hold);
    answers(home);
  }
  corrector.setMode(CorrectorMode::kEndpoint);
  answers(home);
  answer(home, 0.0, true);
  Pose bad = home;
  bad.p.x() = std::nan("");
  answer(bad);
  bad = home;
  bad.q.coeffs() *= 1.1;
  answer(bad);
  answer(home, -stamp - 0.05);  // zero
  answer(home, -1.0);
  answer(home, 1.0);
  answer(home, 0.4);
  answer(home);  // before the one before
  stamp += 1.0;
  for (int i = 0; i < 40; ++i, stamp += 0.05) {
    const AllocationGuard guard;
    const CorrectorOutput output =
        corrector.prepareParts(stamp, stamp, home, i % 2 == 0, i % 3 == 0);
    corrector.commit();
    seen[static_cast<std::size_t>(output.code)] = true;
    corrector.prepare(stamp + 0.01, stamp, home, false);  // and forgotten
    allocations += guard.count();
  }
  {
    const AllocationGuard guard;
    corrector.restart();
    allocations += guard.count();
  }
  EXPECT_EQ(allocations, 0);
  for (const CorrectorCode code :
       {CorrectorCode::kCorrected, CorrectorCode::kCorrectedFaded, CorrectorCode::kCorrectedLimited,
        CorrectorCode::kRigidOnly, CorrectorCode::kPassedOff, CorrectorCode::kPassedNoModel,
        CorrectorCode::kPassedOutside, CorrectorCode::kPassedModelFault,
        CorrectorCode::kPassedBetweenEndpoints, CorrectorCode::kPassedNotAbsolute,
        CorrectorCode::kPassedRobotNotReady, CorrectorCode::kPassedOtherPublisher,
        CorrectorCode::kRefusedNotFinite, CorrectorCode::kRefusedNotUnit,
        CorrectorCode::kRefusedZeroStamp, CorrectorCode::kRefusedStale,
        CorrectorCode::kRefusedFuture, CorrectorCode::kRefusedTimeBackwards,
        CorrectorCode::kRefusedUnreachable})
    EXPECT_TRUE(seen[static_cast<std::size_t>(code)]) << correctorCodeName(code);
}

TEST_F(CorrectorTest, NorDoesItWithPhysicsAsTheMean) {
  Correction physical = model_;
  physical.physics.texts =
      simulationTexts(loadSimulationConfig("config/simulation/raven2_left_case2014.yaml"));
  physical.physics.timing = {physical.delay, 0.01, 100.0};
  Corrector corrector(looseLimits());
  corrector.setModel(physical);
  corrector.setMode(CorrectorMode::kFull);
  const auto desired = [](int i) {
    return Pose{{-0.02 + 1e-4 * i, -0.06, -0.14}, {0.5, -0.5, 0.5, 0.5}};
  };
  corrector.correct(stampOf(0), stampOf(0), desired(0), false);
  int allocations = 0;
  {
    const AllocationGuard guard;
    for (int i = 1; i < 100; ++i) corrector.correct(stampOf(i), stampOf(i), desired(i), false);
    allocations = guard.count();
  }
  EXPECT_EQ(allocations, 0);
}

TEST_F(CorrectorTest, ModelsMaySwapWhilePosesFlow) {
  Corrector corrector(looseLimits());
  corrector.setMode(CorrectorMode::kFull);
  std::atomic<bool> stop{false};
  std::atomic<int> swaps{0};
  std::thread setter([&] {
    Correction next = model_;
    while (!stop && swaps < 50) {
      next.id = std::to_string(swaps);  // another one each time
      corrector.setModel(next);
      ++swaps;
    }
  });
  int i = 0;
  while (swaps < 50 || i < 1000) {
    const CorrectorOutput output = send(corrector, i++);
    EXPECT_TRUE(output.command.p.allFinite());
  }
  stop = true;
  setter.join();
}

TEST(CorrectorLimits, AreChecked) {
  CorrectorLimits limits;
  limits.max_translation = 0.0;
  EXPECT_THROW(Corrector{limits}, InvalidInput);
  EXPECT_THROW(correctorModeFromName("on"), InvalidInput);
}

}  // namespace
}  // namespace raven_correction
