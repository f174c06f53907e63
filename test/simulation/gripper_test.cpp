// SPDX-License-Identifier: BSD-3-Clause
// The jaw: how it moves, when it holds something, and that poses do not touch it.
#include "raven_correction/simulation/gripper.h"

#include <gtest/gtest.h>

#include <cmath>

#include "raven_correction/error.h"
#include "raven_correction/simulation/simulated_arm.h"
#include "simulation/simulations.h"

namespace raven_correction {
namespace {

TEST(Gripper, MovesAtItsSpeedWhateverTheStep) {
  GripperConfig config;
  config.speed = 2.0;
  for (const int steps : {1, 7, 300}) {
    GripperState state;
    state.target = 1.0;
    for (int k = 0; k < steps; ++k) advanceGripper(config, 0.3 / steps, state);
    EXPECT_NEAR(state.opening, 0.6, 1e-12) << steps;
    for (int k = 0; k < steps; ++k) advanceGripper(config, 0.3 / steps, state);
    EXPECT_NEAR(state.opening, 1.0, 1e-12) << steps;
  }
}

TEST(Gripper, HoldsFromClosingToOpening) {
  const GripperConfig config;
  GripperState state;
  const auto moveTo = [&](double opening) {
    state.target = opening;
    for (int k = 0; k < 1000; ++k) advanceGripper(config, 1e-3, state);
    return state.payload;
  };
  EXPECT_EQ(moveTo(-0.1), 0.0) << "never open: there is nothing in it";
  EXPECT_EQ(moveTo(0.8), 0.0);
  EXPECT_EQ(moveTo(config.grasp_opening + 0.01), 0.0) << "not closed far enough";
  EXPECT_EQ(moveTo(0.0), config.payload);
  EXPECT_EQ(moveTo(config.grasp_opening - 0.01), config.payload) << "not opened far enough";
  EXPECT_EQ(moveTo(0.8), 0.0);
  EXPECT_EQ(moveTo(0.0), config.payload) << "again";
}

TEST(Gripper, RefusesBadNumbers) {
  EXPECT_NO_THROW(checkGripper(GripperConfig()));
  for (const GripperField& field : gripperFields()) {
    GripperConfig config;
    config.*field.value = std::nan("");
    EXPECT_THROW(checkGripper(config), InvalidInput) << field.key;
  }
  GripperConfig config;
  config.lower = 1.0;
  config.upper = 0.9;
  EXPECT_THROW(checkGripper(config), InvalidInput);
}

// A pose does not hold the jaw: it is carried along, whatever the arm does, and acts with the delay
// of the poses.
TEST(Gripper, IsCarriedAlongByTheArm) {
  SimulationConfig config = simulationWith("command_delay", {{"tau", 0.1}});
  SimulatedArm arm(config, 1.0);
  ASSERT_TRUE(arm.commandJaw(1.0, 0.8));
  arm.advanceTo(1.1);
  EXPECT_EQ(arm.jaw(), 0.0);
  arm.advanceTo(1.15);
  EXPECT_NEAR(arm.jaw(), 0.05 * config.gripper.speed, 1e-9);
  Pose X = arm.toolPose();
  for (double t = 1.16; t < 2.0; t += 0.02) {
    X.p.z() -= 1e-4;
    ASSERT_TRUE(reproducesPose(arm.command({t, X})));
  }
  arm.advanceTo(2.5);
  EXPECT_LT((arm.toolPose().p - X.p).norm(), 1e-9) << "the jaw does not move the tool point";
  EXPECT_EQ(arm.jaw(), 0.8);
  const ArmState state = arm.state();
  ASSERT_TRUE(arm.commandJaw(2.5, 0.0));
  arm.advanceTo(3.0);
  EXPECT_EQ(arm.payload(), config.gripper.payload);
  arm.restore(state);
  EXPECT_EQ(arm.jaw(), 0.8) << "part of the state";
  EXPECT_EQ(arm.payload(), 0.0);
}

TEST(Gripper, RefusesWhatIsNoCommandAndStopsAtItsLimits) {
  const SimulationConfig config = shippedSimulation("nominal");
  SimulatedArm arm(config, 1.0);
  EXPECT_FALSE(arm.commandJaw(std::nan(""), 0.5));
  EXPECT_FALSE(arm.commandJaw(1.0, std::nan("")));
  EXPECT_TRUE(arm.commandJaw(1.2, 7.0));
  EXPECT_FALSE(arm.commandJaw(1.1, 0.5)) << "stamp runs backwards";
  arm.advanceTo(3.0);
  EXPECT_EQ(arm.jaw(), config.gripper.upper);
}

}  // namespace
}  // namespace raven_correction
