// SPDX-License-Identifier: BSD-3-Clause
// No answer of a corrector allocates: it is on the live path. The guard replaces malloc, so it can
// be in one file of a program only.
#include "correction/corrector_fixture.h"
#include "raven_correction/correction/path_follower.h"
#include "raven_correction/correction/training_config.h"
#include "robot/robots.h"
#include "support/allocation_guard.h"

namespace raven_correction {
namespace {

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

// Inverse kinematics of every pose, and of the pose ahead.
TEST_F(CorrectorTest, NorDoesItWithThePlayOfTheJoints) {
  const auto desired = [](int i) {
    return Pose{{-0.02 + 1e-4 * i, -0.06, -0.14}, {0.5, -0.5, 0.5, 0.5}};
  };
  MotionOptions motion;
  knowRobot("config/robots/raven2_left.yaml", motion);
  const Correction model = simpleModel(VelocityKind::kPast, desired(0), Pose(), motion);
  ASSERT_TRUE(hasJointPlay(model.motion));
  Corrector corrector(looseLimits());
  corrector.setModel(model);
  corrector.setMode(CorrectorMode::kFull);
  corrector.correct(stampOf(0), stampOf(0), desired(0), false);
  int allocations = 0, corrected = 0;
  for (int i = 1; i < 100; ++i) {
    const Lookahead ahead{stampOf(i + 5), desired(i + 5)};
    const AllocationGuard guard;
    corrected +=
        corrector.correct(stampOf(i), stampOf(i), desired(i), false, i % 2 == 0 ? &ahead : nullptr)
            .code == CorrectorCode::kCorrected;
    allocations += guard.count();
  }
  EXPECT_EQ(allocations, 0);
  EXPECT_GT(corrected, 90);
}

TEST_F(CorrectorTest, NorDoesItWithAPathAhead) {
  Corrector corrector(looseLimits());
  corrector.setModel(model_);
  corrector.setMode(CorrectorMode::kFull);
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
        corrector.correct(stampOf(i), stampOf(i), inside(i), false, pose ? &ahead : nullptr).ahead;
    allocations += guard.count();
  }
  EXPECT_EQ(allocations, 0);
  EXPECT_GT(ahead_of, 140);
}

}  // namespace
}  // namespace raven_correction
