// SPDX-License-Identifier: BSD-3-Clause
// What the robot takes: the nearest command within its step, and the share of a correction that its
// joints reach, on the real chain of the Raven.
#include "raven_correction/correction/robot_limits.h"

#include <gtest/gtest.h>

#include <limits>

#include "raven_correction/correction/corrector.h"
#include "raven_correction/error.h"
#include "robot/robots.h"
#include "support/random_poses.h"
#include "support/simple_model.h"

namespace raven_correction {
namespace {

constexpr double kStep = 0.015, kTurn = 0.5;

RobotLimits crtk() {
  RobotLimits limits;
  limits.max_step = kStep;
  limits.max_turn = kTurn;
  return limits;
}

Eigen::AlignedBox3d everywhere() {
  const double infinity = std::numeric_limits<double>::infinity();
  return {Eigen::Vector3d::Constant(-infinity), Eigen::Vector3d::Constant(infinity)};
}

TEST(KeepNear, IsAProjectionThatNeverLeadsAwayFromTheDesiredPose) {
  std::mt19937_64 random(3);
  int shortened = 0;
  for (int i = 0; i < 2000; ++i) {
    const Pose tool{randomVector(random, 0.01), expRotation(randomVector(random, 0.3))};
    const Pose desired{randomVector(random, 0.02), expRotation(randomVector(random, 0.5))};
    const Pose corrected{desired.p + randomVector(random, 0.02),
                         (desired.q * expRotation(randomVector(random, 0.4))).normalized()};
    const NearTool near = keepNear(crtk(), &tool, everywhere(), desired, corrected);
    shortened += near.shortened_position;
    const double own = (desired.p - tool.p).norm();
    const double own_turn = rotationAngle(desired.q, tool.q);
    EXPECT_LE((near.command.p - tool.p).norm(), std::max(kStep, own) + 1e-12);
    EXPECT_LE(rotationAngle(near.command.q, tool.q), std::max(kTurn, own_turn) + 1e-9);
    EXPECT_LE((near.command.p - desired.p).norm(), (corrected.p - desired.p).norm() + 1e-12);
    EXPECT_EQ(near.desired_beyond, own > kStep || own_turn > kTurn);
    if (!near.shortened_position) {
      EXPECT_EQ(near.command.p, corrected.p);
    }
    if (!near.shortened_orientation) {
      EXPECT_EQ(near.command.q.coeffs(), corrected.q.coeffs());
    }
    // Another correction close by: the command moves no more than it.
    Pose other = corrected;
    other.p += randomVector(random, 0.002);
    EXPECT_LE(
        (keepNear(crtk(), &tool, everywhere(), desired, other).command.p - near.command.p).norm(),
        (other.p - corrected.p).norm() + 1e-12);
  }
  EXPECT_GT(shortened, 200);
}

TEST(KeepNear, StaysInTheBoxAndNearTheToolAtOnce) {
  std::mt19937_64 random(4);
  int both = 0;
  for (int i = 0; i < 5000; ++i) {
    const Pose tool{randomVector(random, 0.01), Eigen::Quaterniond::Identity()};
    const Pose desired{randomVector(random, 0.015), Eigen::Quaterniond::Identity()};
    Eigen::AlignedBox3d room(Eigen::Vector3d::Constant(-0.01), Eigen::Vector3d::Constant(0.01));
    room.extend(desired.p);
    const auto command = [&](const Eigen::Vector3d& corrected) {
      return keepNear(crtk(), &tool, room, desired, {corrected, Eigen::Quaterniond::Identity()});
    };
    const auto isAllowed = [&](const Eigen::Vector3d& p) {
      return room.contains(p) &&
             (p - tool.p).norm() <= std::max(kStep, (desired.p - tool.p).norm()) + 1e-12;
    };
    const Eigen::Vector3d corrected = desired.p + randomVector(random, 0.02);
    const NearTool near = command(corrected);
    both += near.shortened_room && near.shortened_position;
    EXPECT_TRUE(isAllowed(near.command.p)) << i;
    EXPECT_LE((near.command.p - desired.p).norm(), (corrected - desired.p).norm() + 1e-12);
    EXPECT_LT((command(near.command.p).command.p - near.command.p).norm(), 1e-12);
    // It is the nearest one: nothing else that is allowed is nearer to the corrected position.
    for (int k = 0; k < 20; ++k) {
      const Eigen::Vector3d other = command(near.command.p + randomVector(random, 0.005)).command.p;
      EXPECT_GE((other - corrected).norm(), (near.command.p - corrected).norm() - 1e-9);
    }
    // And moves no more than the corrected position does.
    const Eigen::Vector3d moved = corrected + randomVector(random, 0.002);
    EXPECT_LE((command(moved).command.p - near.command.p).norm(),
              (moved - corrected).norm() + 1e-9);
  }
  EXPECT_GT(both, 300);
  // Without a tool the box alone.
  const Eigen::AlignedBox3d room(Eigen::Vector3d::Zero(), Eigen::Vector3d::Ones());
  EXPECT_EQ(keepNear(crtk(), nullptr, room, Pose(), {{2.0, 0.5, -1.0}, Pose().q}).command.p,
            Eigen::Vector3d(1.0, 0.5, 0.0));
}

TEST(KeepNear, ZeroChecksNothing) {
  const Pose tool, far{{1.0, 2.0, 3.0}, expRotation({0.0, 0.0, 3.0})};
  const NearTool near = keepNear(RobotLimits(), &tool, everywhere(), Pose(), far);
  EXPECT_EQ(near.command.p, far.p);
  EXPECT_FALSE(near.desired_beyond);
}

TEST(RobotReach, RefusesLimitsThatAreNone) {
  RobotLimits limits;
  limits.max_turn = -1.0;
  EXPECT_THROW(RobotReach{limits}, InvalidInput);
}

class RobotReachTest : public ::testing::Test {
 protected:
  RobotReachTest() : chain_(std::make_shared<KinematicChain>(shippedRobot("raven2_left"))) {
    limits_.chain = chain_;
  }
  std::shared_ptr<const KinematicChain> chain_;
  RobotLimits limits_;
};

TEST_F(RobotReachTest, PosesOfJointsInsideTheLimitsAreReachedOthersAreNot) {
  RobotReach reach(limits_);
  JointVector q = chain_->home();
  EXPECT_TRUE(reach.reaches(chain_->forward(q)));
  const int insertion = chain_->indexOf("insertion");
  q(insertion) = chain_->lower()(insertion) + 1e-4;
  EXPECT_TRUE(reach.reaches(chain_->forward(q)));
  q(insertion) = chain_->lower()(insertion) - 0.005;
  EXPECT_FALSE(reach.reaches(chain_->forward(q)));
}

TEST_F(RobotReachTest, TheLargestShareInReachIsFound) {
  RobotReach reach(limits_);
  const int insertion = chain_->indexOf("insertion");
  JointVector q = chain_->home();
  q(insertion) = chain_->lower()(insertion) + 0.004;
  const Pose desired = chain_->forward(q);
  q(insertion) -= 0.016;  // a quarter of the way is inside the limit
  const Eigen::Vector3d translation = chain_->forward(q).p - desired.p;
  reach.follow(desired);
  EXPECT_NEAR(reach.reachableShare(translation, Eigen::Vector3d::Zero()), 0.25, 0.01);
  EXPECT_EQ(reach.reachableShare(-translation, Eigen::Vector3d::Zero()), 1.0);
  // From out of reach into reach, and nowhere into reach.
  reach.follow({desired.p + translation, desired.q});
  EXPECT_EQ(reach.reachableShare(-translation, Eigen::Vector3d::Zero()), 1.0);
  EXPECT_EQ(reach.reachableShare(translation, Eigen::Vector3d::Zero()), 0.0);
}

TEST_F(RobotReachTest, AnotherTurnOfTheToolIsNoWayToReachAPose) {
  // The roll has 364 degrees: what is beyond its end on one side is inside it on the other.
  RobotReach reach(limits_);
  const int roll = chain_->indexOf("tool_roll");
  for (const double side : {1.0, -1.0}) {
    JointVector q = chain_->home();
    q(roll) = side * (chain_->upper()(roll) - 0.02);
    const Pose desired = chain_->forward(q);
    // As a planner gets there: turning.
    for (double angle = 0.0; angle < 1.0; angle += 0.05) {
      JointVector on_the_way = chain_->home();
      on_the_way(roll) = angle * q(roll);
      reach.follow(chain_->forward(on_the_way));
      reach.commit();
    }
    reach.follow(desired);
    q(roll) += side * 0.1;
    const Pose corrected = chain_->forward(q);
    EXPECT_FALSE(reach.reaches(corrected));
    const Eigen::Vector3d rotation = logRotation(desired.q.conjugate() * corrected.q);
    EXPECT_NEAR(reach.reachableShare(corrected.p - desired.p, rotation), 0.2, 0.01);
    EXPECT_EQ(reach.reachableShare(desired.p - corrected.p, -rotation), 1.0);
    // Where the planner itself goes on through the end, its joints come from the other side.
    reach.follow(corrected);
    EXPECT_TRUE(reach.reaches(corrected));
  }
}

TEST_F(RobotReachTest, JointsThatWereNotCommittedDoNotLead) {
  RobotReach reach(limits_);
  const int roll = chain_->indexOf("tool_roll");
  JointVector q = chain_->home();
  q(roll) = -3.15;
  const Pose desired = chain_->forward(q);  // the same as at a roll of 3.13
  q(roll) = 3.0;
  reach.follow(chain_->forward(q));
  reach.commit();
  q(roll) = -3.0;
  reach.follow(chain_->forward(q));  // of a command that was not sent
  reach.follow(desired);
  q(roll) = 3.05;
  EXPECT_TRUE(reach.reaches(chain_->forward(q)));
}

TEST_F(RobotReachTest, ACorrectorNeverSendsWhatTheJointsDoNotReach) {
  // The rigid step of the model leads beyond the end of the insertion, away from the remote centre.
  const int insertion = chain_->indexOf("insertion");
  JointVector q = chain_->home();
  q(insertion) = chain_->lower()(insertion) + 0.03;
  const Pose start = chain_->forward(q);
  q(insertion) -= 0.01;
  const Eigen::Vector3d outwards = (chain_->forward(q).p - start.p).normalized();

  Correction model = simpleModel(VelocityKind::kNone);
  model.process = {};
  model.rigid = {0.02 * outwards, Eigen::Quaterniond::Identity()};
  model.trust.workspace_min.setConstant(-1.0);
  model.trust.workspace_max.setConstant(1.0);
  CorrectorLimits limits;
  limits.robot = limits_;
  Corrector corrector(limits);
  corrector.setModel(model);
  corrector.setMode(CorrectorMode::kFull);
  RobotReach judge(limits_);
  int limited = 0;
  Pose last = start;
  // Towards the limit and back at 50 mm/s.
  for (int i = 0; i < 1200; ++i) {
    const double way = 0.05 * 1e-3 * (i < 600 ? i : 1200 - i);
    const Pose desired{start.p + std::min(way, 0.0299) * outwards, start.q};
    const double stamp = 100.0 + 1e-3 * i;
    const CorrectorOutput output = corrector.correct(stamp, stamp, desired, false);
    ASSERT_FALSE(isRefused(output.code)) << i << " " << correctorCodeName(output.code);
    EXPECT_TRUE(judge.reaches(output.command)) << i;
    if (i > 0) {
      EXPECT_LE((output.command.p - last.p).norm(), 0.05 * 1e-3 + 0.15 * 1e-3 + 1e-9) << i;
    }
    limited += (output.limits & kLimitReach) != 0;
    last = output.command;
  }
  EXPECT_GT(limited, 300);
}

TEST_F(RobotReachTest, WhatIsOutOfReachEvenSoIsRefusedUntilTheCorrectionIsTakenBack) {
  const int insertion = chain_->indexOf("insertion");
  JointVector q = chain_->home();
  q(insertion) = chain_->lower()(insertion) + 0.03;
  const Pose start = chain_->forward(q);
  q(insertion) -= 0.029;
  const Pose end = chain_->forward(q);
  Correction model = simpleModel(VelocityKind::kNone);
  model.process = {};
  model.rigid = {0.02 * (end.p - start.p).normalized(), Eigen::Quaterniond::Identity()};
  model.trust.workspace_min.setConstant(-1.0);
  model.trust.workspace_max.setConstant(1.0);
  CorrectorLimits limits;
  limits.robot = limits_;
  Corrector corrector(limits);
  corrector.setModel(model);
  corrector.setMode(CorrectorMode::kFull);
  double stamp = 100.0;
  for (int i = 0; i < 300; ++i, stamp += 1e-3) corrector.correct(stamp, stamp, start, false);
  // The planner jumps to the end: the correction in force would lead beyond it.
  EXPECT_EQ(corrector.correct(stamp, stamp, end, false).code, CorrectorCode::kRefusedUnreachable);
  RobotReach judge(limits_);
  CorrectorOutput output;
  for (int i = 0; i < 400; ++i) {
    stamp += 1e-3;
    output = corrector.correct(stamp, stamp, end, false);
    if (!isRefused(output.code)) {
      EXPECT_TRUE(judge.reaches(output.command));
    }
  }
  EXPECT_EQ(output.code, CorrectorCode::kCorrectedLimited);
}

TEST_F(RobotReachTest, WhereThePlannerItselfIsOutOfReachItsPosePassesInTheEnd) {
  const int insertion = chain_->indexOf("insertion");
  JointVector q = chain_->home();
  q(insertion) = chain_->lower()(insertion) + 0.03;
  const Pose start = chain_->forward(q);
  q(insertion) = chain_->lower()(insertion) - 0.02;
  const Pose beyond = chain_->forward(q);
  Correction model = simpleModel(VelocityKind::kNone);
  model.process = {};
  model.rigid = {0.02 * (beyond.p - start.p).normalized(), Eigen::Quaterniond::Identity()};
  model.trust.workspace_min.setConstant(-1.0);
  model.trust.workspace_max.setConstant(1.0);
  CorrectorLimits limits;
  limits.robot = limits_;
  Corrector corrector(limits);
  corrector.setModel(model);
  corrector.setMode(CorrectorMode::kFull);
  double stamp = 100.0;
  for (int i = 0; i < 300; ++i, stamp += 1e-3) corrector.correct(stamp, stamp, start, false);
  CorrectorOutput output = corrector.correct(stamp, stamp, beyond, false);
  EXPECT_EQ(output.code, CorrectorCode::kRefusedUnreachable);
  const auto steps = static_cast<int>(0.02 / (limits.max_translation_rate * 1e-3)) + 2;
  for (int i = 0; i < steps; ++i) {
    stamp += 1e-3;
    output = corrector.correct(stamp, stamp, beyond, false);
  }
  EXPECT_EQ(output.code, CorrectorCode::kCorrectedLimited);
  EXPECT_EQ(output.limits, kLimitReach);
  EXPECT_EQ(output.command.p, beyond.p);
  EXPECT_EQ(output.command.q.coeffs(), beyond.q.coeffs());
}

// The side of the box once turned a shortened command back out of the robot's step, axis by axis.
TEST(Corrector, TheBoxDoesNotBreakTheStepOfTheRobot) {
  CorrectorLimits limits;
  limits.max_translation_rate = 10.0;
  limits.robot.max_step = 0.01;
  limits.box_min.setConstant(-0.005);
  limits.box_max.setConstant(0.005);
  std::mt19937_64 random(6);
  Correction model = simpleModel(VelocityKind::kNone);
  model.process = {};
  model.trust.workspace_min.setConstant(-1.0);
  model.trust.workspace_max.setConstant(1.0);
  int boxed = 0;
  for (int i = 0; i < 500; ++i) {
    model.rigid = {randomVector(random, 0.015), Eigen::Quaterniond::Identity()};
    Corrector corrector(limits);
    corrector.setModel(model);
    corrector.setMode(CorrectorMode::kFull);
    const Pose tool{randomVector(random, 0.008), Eigen::Quaterniond::Identity()};
    const Pose desired{randomVector(random, 0.005), Eigen::Quaterniond::Identity()};
    corrector.setMeasured(100.0, 100.0, tool);
    const CorrectorOutput output = corrector.correct(100.0, 100.0, desired, false);
    boxed += (output.limits & kLimitBox) != 0;
    EXPECT_LE((output.command.p - tool.p).norm(),
              std::max(0.01, (desired.p - tool.p).norm()) + 1e-9);
    for (int k = 0; k < 3; ++k)
      EXPECT_LE(std::abs(output.command.p(k)), std::max(0.005, std::abs(desired.p(k))) + 1e-12);
  }
  EXPECT_GT(boxed, 100);
}

}  // namespace
}  // namespace raven_correction
