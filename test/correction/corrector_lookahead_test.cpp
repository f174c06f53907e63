// SPDX-License-Identifier: BSD-3-Clause
// What becomes of poses whose path is announced: they are corrected for the pose ahead.
#include "correction/corrector_fixture.h"

namespace raven_correction {
namespace {

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

// Of a planner that dies in the middle of its path the last command is the one for the pose ahead:
// the tool goes on by the way of that lead, and no further.
TEST_F(LookaheadTest, APlannerThatDiesLeavesTheCommandByTheLeadAhead) {
  CorrectorOutput last;
  for (int i = 0; i < 60; ++i) last = sendAnnounced(i);
  for (int i = 0; i < 59 + 6; ++i) {
    const CorrectorOutput causal = send(causal_, i);
    if (i == 59 + 5) expectSameCommand(last, causal);
  }
}

// When it is back, without a path, the command returns to the pose of now in limited steps.
TEST_F(LookaheadTest, WhatComesAfterItsDeathIsLimitedInItsSteps) {
  CorrectorLimits limits;
  limits.max_translation_rate = 0.02;
  limits.max_step_time = 0.05;
  Corrector corrector(limits);
  corrector.setModel(model_);
  corrector.setMode(CorrectorMode::kFull);
  Pose command;
  for (int i = 0; i < 300; ++i) {
    const Lookahead ahead = aheadOf(i);
    command = corrector.correct(stampOf(i), stampOf(i), inside(i), false, &ahead).command;
  }
  const double silence = 30.0;
  for (int i = 300; i < 400; ++i) {
    const double stamp = stampOf(i) + silence;
    const Pose before = command;
    const CorrectorOutput output = corrector.correct(stamp, stamp, inside(299), false);
    EXPECT_FALSE(output.ahead);
    command = output.command;
    EXPECT_LE((command.p - before.p).norm(), 0.02 * (i == 300 ? 0.05 : 0.02) + 1e-9) << i;
  }
  const CorrectorOutput at_rest = causal_.correct(stampOf(0), stampOf(0), inside(299), false);
  EXPECT_LT((command.p - at_rest.command.p).norm(), 1e-6);
}

}  // namespace
}  // namespace raven_correction
