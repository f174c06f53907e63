// SPDX-License-Identifier: BSD-3-Clause
// What becomes of one pose. What a stream of them does to the correction is
// corrector_stream_test.cpp, what an announced path does corrector_lookahead_test.cpp.
#include <array>
#include <limits>

#include "correction/corrector_fixture.h"
#include "raven_correction/error.h"
#include "robot/robots.h"

namespace raven_correction {
namespace {

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

TEST_F(CorrectorTest, TheDistanceIsThatFromTheBoxOfTheTraining) {
  Corrector corrector(looseLimits());
  corrector.setModel(model_);
  corrector.setMode(CorrectorMode::kFull);
  EXPECT_EQ(send(corrector, 0).distance, 0.0);
  const Pose far{{0.08, 0.09, 0.0}, inside(0).q};
  EXPECT_NEAR(corrector.correct(101.0, 101.0, far, false).distance, 0.05, 1e-12);
}

TEST(CorrectorLimits, AreChecked) {
  CorrectorLimits limits;
  limits.max_translation = 0.0;
  EXPECT_THROW(Corrector{limits}, InvalidInput);
  EXPECT_THROW(correctorModeFromName("on"), InvalidInput);
}

}  // namespace
}  // namespace raven_correction
