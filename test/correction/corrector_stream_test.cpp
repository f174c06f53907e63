// SPDX-License-Identifier: BSD-3-Clause
// What a stream of poses does to the correction in force: steps, silences, holds, increments,
// models that are swapped, the tool that is measured, poses that are not sent. One pose is
// corrector_test.cpp.
#include <atomic>
#include <thread>

#include "correction/corrector_fixture.h"

namespace raven_correction {
namespace {

TEST_F(CorrectorTest, ANewModelKnowsTheMotionSoFar) {
  // The way back through a simulation depends on the velocity: it undoes a delay.
  Correction first = simpleModel(VelocityKind::kPast);
  first.process = {};
  first.physics.texts =
      simulationTexts(loadSimulationConfig("config/simulation/raven2_left_case2014.yaml"));
  first.physics.timing = {first.delay, 0.01, 100.0};
  first.trust.workspace_min.setConstant(-1.0);
  first.trust.workspace_max.setConstant(1.0);
  Correction again = first;
  again.id = "the same under another name";
  const auto moving = [](int i) {  // 25 mm/s
    return Pose{{-0.02 + 5e-4 * i, -0.06, -0.14}, {0.5, -0.5, 0.5, 0.5}};
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
  EXPECT_GT((alone.p - expected.p).norm(), 1e-3);
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
  EXPECT_LE((output.command.p - last.p).norm(),
            std::max(0.004, (inside(10).p - last.p).norm()) + 1e-9);
  corrector.setMeasured(stampOf(10), stampOf(16), tool);
  EXPECT_EQ(send(corrector, 16).tool_known_by, ToolKnownBy::kLastCommand);
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

}  // namespace
}  // namespace raven_correction
