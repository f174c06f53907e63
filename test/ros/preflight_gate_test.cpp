// SPDX-License-Identifier: BSD-3-Clause
#include "raven_correction/ros/preflight_gate.h"

#include <gtest/gtest.h>

namespace raven_correction {
namespace {

TEST(PreflightGate, ClearsOneModelUntilTheNextHoming) {
  PreflightGate gate(true);
  EXPECT_EQ(gate.of("a"), PreflightState::kNeeded);
  gate.clear("a", PreflightState::kPassed, gate.homings());
  EXPECT_EQ(gate.of("a"), PreflightState::kPassed);
  EXPECT_EQ(gate.of("b"), PreflightState::kNeeded);
  gate.clear("b", PreflightState::kOverridden, gate.homings());
  gate.noteHoming();
  EXPECT_EQ(gate.of("a"), PreflightState::kNeeded);
  EXPECT_EQ(gate.of("b"), PreflightState::kNeeded);
}

TEST(PreflightGate, AHomingDuringAPreflightVoidsIt) {
  PreflightGate gate(true);
  const std::uint32_t begun = gate.homings();
  gate.noteHoming();
  gate.clear("a", PreflightState::kPassed, begun);
  EXPECT_EQ(gate.of("a"), PreflightState::kNeeded);
}

TEST(PreflightGate, AModelThatFailsIsClearedNoMore) {
  PreflightGate gate(true);
  gate.clear("a", PreflightState::kPassed, gate.homings());
  gate.revoke("a");
  EXPECT_FALSE(isCleared(gate.of("a")));
}

TEST(PreflightGate, AsksForNothingWhereItIsNotRequired) {
  PreflightGate gate(false);
  EXPECT_EQ(gate.of("a"), PreflightState::kNotRequired);
  gate.noteHoming();
  EXPECT_TRUE(isCleared(gate.of("")));
}

}  // namespace
}  // namespace raven_correction
