// SPDX-License-Identifier: BSD-3-Clause
// What becomes of one pose. What a stream of them does to the correction is
// corrector_stream_test.cpp.
#include <array>
#include <limits>

#include "correction/corrector_fixture.h"
#include "raven_correction/correction/path_follower.h"
#include "raven_correction/error.h"
#include "robot/robots.h"
#include "support/allocation_guard.h"

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
  overflowing.process.groups[0].weights.setConstant(1.7e308);
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
  for (const Correction& next : {overflowing, faded, rigid, model}) {
    corrector.setModel(next);
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

TEST(CorrectorLimits, AreChecked) {
  CorrectorLimits limits;
  limits.max_translation = 0.0;
  EXPECT_THROW(Corrector{limits}, InvalidInput);
  EXPECT_THROW(correctorModeFromName("on"), InvalidInput);
}

/// The answers to a stream whose poses are announced five poses before.
class LookaheadTest : public CorrectorTest {
 protected:
  LookaheadTest() : corrector_(looseLimits()), causal_(looseLimits()) {
    for (Corrector* const corrector : {&corrector_, &causal_}) {
      corrector->setModel(model_);
      corrector->setMode(CorrectorMode::kFull);
    }
  }
  static Lookahead aheadOf(int i) { return {stampOf(i + 5), inside(i + 5)}; }
  CorrectorOutput sendAnnounced(int i) {
    const Lookahead ahead = aheadOf(i);
    return corrector_.correct(stampOf(i), stampOf(i), inside(i), false, &ahead);
  }
  static void expectSameCommand(const CorrectorOutput& a, const CorrectorOutput& b) {
    EXPECT_LT((a.command.p - b.command.p).norm(), 1e-9);
    EXPECT_LT(rotationAngle(a.command.q, b.command.q), 1e-8);
  }

  Corrector corrector_, causal_;
};

TEST_F(LookaheadTest, TheCommandIsThatOfThePoseAheadWithItsMotion) {
  std::vector<CorrectorOutput> later;
  for (int i = 0; i < 105; ++i) later.push_back(send(causal_, i));
  for (int i = 0; i < 100; ++i) {
    const CorrectorOutput output = sendAnnounced(i);
    EXPECT_TRUE(output.ahead);
    if (i > 50) expectSameCommand(output, later[static_cast<std::size_t>(i + 5)]);
  }
}

TEST_F(LookaheadTest, WithoutItTheAnswerIsTheCausalOneAtOnce) {
  for (int i = 0; i < 100; ++i) {
    const CorrectorOutput causal = send(causal_, i);
    if (i >= 30 && i < 60) {
      sendAnnounced(i);
    } else {
      const CorrectorOutput output = send(corrector_, i);
      EXPECT_FALSE(output.ahead);
      expectSameCommand(output, causal);
    }
  }
}

TEST_F(LookaheadTest, WhatIsPreparedAndNotSentChangesNothing) {
  for (int i = 0; i < 60; ++i) {
    const Lookahead far{stampOf(i + 9), inside(i + 40)};
    if (i % 2 == 0) corrector_.prepare(stampOf(i), stampOf(i), inside(i), false, &far);
    const CorrectorOutput output = sendAnnounced(i);
    const Lookahead ahead = aheadOf(i);
    expectSameCommand(output, causal_.correct(stampOf(i), stampOf(i), inside(i), false, &ahead));
  }
}

TEST_F(LookaheadTest, OutsideTheWorkspaceAndInModeEndpointThePoseOfNowCounts) {
  for (int i = 0; i < 20; ++i) sendAnnounced(i);
  const Lookahead outside{stampOf(25), {{0.5, 0.0, 0.0}, inside(25).q}};
  EXPECT_FALSE(corrector_.correct(stampOf(20), stampOf(20), inside(20), false, &outside).ahead);
  corrector_.setMode(CorrectorMode::kEndpoint);
  const Lookahead ahead = aheadOf(21);
  EXPECT_FALSE(corrector_.correct(stampOf(21), stampOf(21), inside(21), true, &ahead).ahead);
  corrector_.setMode(CorrectorMode::kOff);
  const CorrectorOutput off = sendAnnounced(22);
  EXPECT_TRUE(same(off.command, inside(22)));
}

TEST_F(LookaheadTest, DoesNotAllocate) {
  PathFollower path;
  path.begin();
  for (int i = 0; i < 200; ++i) path.add(inside(i));
  int allocations = 0, ahead_of = 0;
  for (int i = 0; i < 150; ++i) {
    const AllocationGuard guard;
    path.follow(stampOf(i), inside(i));
    const auto pose = path.ahead(0.1);
    const Lookahead ahead{stampOf(i) + 0.1, pose.value_or(Pose())};
    ahead_of +=
        corrector_.correct(stampOf(i), stampOf(i), inside(i), false, pose ? &ahead : nullptr).ahead;
    allocations += guard.count();
  }
  EXPECT_EQ(allocations, 0);
  EXPECT_GT(ahead_of, 140);
}

}  // namespace
}  // namespace raven_correction
