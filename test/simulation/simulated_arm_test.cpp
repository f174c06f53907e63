// SPDX-License-Identifier: BSD-3-Clause
// The simulated arm as a whole: ideal without effects, independent of step and of how one asks,
// deterministic, restorable, and robust against commands that are none.
#include "raven_correction/simulation/simulated_arm.h"

#include <gtest/gtest.h>

#include <cmath>

#include "raven_correction/error.h"
#include "raven_correction/robot/chain_file.h"
#include "simulation/simulations.h"

namespace raven_correction {
namespace {

/// Commands along a slow loop in the measured workspace, 50 Hz.
PoseStream loop(const SimulationConfig& config, double start, double duration) {
  DebridementMotion motion(config.debridement, config.robot, 7);
  PoseStream commands;
  double time = start;
  while (time < start + duration) {
    for (const StampedPose& command : motion.next(time).commands) commands.push_back(command);
    time = commands.back().stamp + 0.02;
  }
  return commands;
}

bool equal(const Pose& a, const Pose& b) { return a.p == b.p && a.q.coeffs() == b.q.coeffs(); }

TEST(SimulatedArm, NominalArmIsIdeal) {
  const SimulationConfig config = shippedSimulation("nominal");
  SimulatedArm arm(config, 1.0);
  const PoseStream commands = loop(config, 1.0, 5.0);
  for (const StampedPose& command : commands) {
    EXPECT_EQ(arm.command(command), IkStatus::kOk);
    arm.advanceTo(command.stamp + 0.01);
    EXPECT_LT((arm.toolPose().p - command.pose.p).norm(), 1e-9);
    EXPECT_LT(rotationAngle(arm.toolPose().q, command.pose.q), 1e-8);
    EXPECT_TRUE(equal(arm.toolPose(), arm.measuredPose()));
    EXPECT_TRUE(equal(arm.toolPose(), arm.setpointPose()));
  }
}

// Every effect with all its parameters at zero, and all effects at once, change not a single bit.
TEST(SimulatedArm, EffectsAtZeroAreNominal) {
  const SimulationConfig nominal = shippedSimulation("nominal");
  std::vector<SimulationConfig> cases;
  for (const std::string& name : effectNames()) cases.push_back(simulationWith(name, {}));
  cases.push_back(nominal);
  for (const std::string& name : effectNames()) cases.back().set(makeEffect(name, nominal.robot));
  const PoseStream commands = loop(nominal, 1.0, 3.0);
  for (const SimulationConfig& config : cases) {
    SimulatedArm reference(nominal, 1.0);
    SimulatedArm arm(config, 1.0);
    for (const StampedPose& command : commands) {
      reference.command(command);
      arm.command(command);
      reference.advanceTo(command.stamp + 0.013);
      arm.advanceTo(command.stamp + 0.013);
      ASSERT_TRUE(equal(arm.toolPose(), reference.toolPose())) << config.effects[0]->name();
      ASSERT_TRUE(equal(arm.measuredPose(), reference.measuredPose()));
    }
  }
}

/// Largest difference in joints between an arm with steps of 1 ms and one with `step`, asked at odd
/// instants besides.
double largestDifference(SimulationConfig config, double step) {
  const PoseStream commands = loop(config, 1.0, 6.0);
  SimulatedArm fine(config, 1.0);
  config.step = step;
  SimulatedArm other(config, 1.0);
  std::size_t next = 0;
  double difference = 0.0;
  for (double t = 1.0; t < 6.5; t += 0.0337) {
    for (; next < commands.size() && commands[next].stamp <= t; ++next) {
      fine.command(commands[next]);
      other.command(commands[next]);
    }
    fine.advanceTo(t);
    other.advanceTo(t - 0.0107);
    other.advanceTo(t);
    difference = std::max(difference, (fine.joints() - other.joints()).cwiseAbs().maxCoeff());
  }
  return difference;
}

// With set-points held, every operator is exact for any step. Exceptions: backlash behind coupling
// sees the sum of two joints, which may turn round between two samples; motor_saturation takes the
// other joints to move on evenly during a step.
TEST(SimulatedArm, ResultDoesNotDependOnTheStep) {
  SimulationConfig config = shippedSimulation("raven2_left_case2014");
  EXPECT_LT(largestDifference(config, 1e-4), 0.02);
  EXPECT_LT(largestDifference(config, 1e-2), 0.15);
  config.remove("motor_saturation");
  EXPECT_LT(largestDifference(config, 1e-3), 5e-4);
  EXPECT_LT(largestDifference(config, 1e-4), 5e-4);
  config.remove("joint_coupling");
  EXPECT_LT(largestDifference(config, 1e-3), 1e-12);
  EXPECT_LT(largestDifference(config, 0.1), 1e-12);
}

TEST(SimulatedArm, LinearSetpointsPassThroughCommands) {
  SimulationConfig config = shippedSimulation("nominal");
  config.setpoints = SetpointMode::kLinear;
  SimulatedArm arm(config, 0.0);
  Pose a = arm.toolPose();
  Pose b = a;
  b.p.z() -= 0.01;
  arm.command({1.0, a});
  arm.command({1.1, b});
  arm.advanceTo(1.05);
  const JointVector half = arm.joints();
  arm.advanceTo(1.1);
  EXPECT_LT((arm.toolPose().p - b.p).norm(), 1e-9);
  EXPECT_LT((half - 0.5 * (config.robot.home() + arm.joints())).norm(), 1e-9);
}

TEST(SimulatedArm, StateCanBeRestored) {
  const SimulationConfig config = shippedSimulation("raven2_left_case2014");
  const PoseStream commands = loop(config, 1.0, 4.0);
  SimulatedArm arm(config, 1.0);
  for (const StampedPose& command : commands) arm.command(command);
  arm.advanceTo(2.0);
  const ArmState state = arm.state();
  arm.advanceTo(3.5);
  const Pose first = arm.toolPose();
  arm.restore(state);
  EXPECT_EQ(arm.time(), 2.0);
  arm.advanceTo(3.5);
  EXPECT_TRUE(equal(first, arm.toolPose()));
}

TEST(SimulatedArm, ResetForgetsEverything) {
  const SimulationConfig config = shippedSimulation("raven2_left_case2014");
  const PoseStream commands = loop(config, 1.0, 2.0);
  SimulatedArm arm(config, 1.0);
  for (const StampedPose& command : commands) arm.command(command);
  arm.advanceTo(3.0);
  arm.reset(1.0);
  SimulatedArm fresh(config, 1.0);
  for (const StampedPose& command : commands) {
    arm.command(command);
    fresh.command(command);
  }
  arm.advanceTo(2.5);
  fresh.advanceTo(2.5);
  EXPECT_TRUE(equal(arm.toolPose(), fresh.toolPose()));
}

TEST(SimulatedArm, RefusesWhatIsNoCommand) {
  const SimulationConfig config = shippedSimulation("nominal");
  SimulatedArm arm(config, 1.0);
  const Pose rest = arm.toolPose();
  Pose bad = rest;
  bad.p.x() = std::nan("");
  EXPECT_EQ(arm.command({1.0, bad}), IkStatus::kInvalidInput);
  EXPECT_EQ(arm.command({std::nan(""), rest}), IkStatus::kInvalidInput);
  Pose away = rest;
  away.p = config.robot.baseTransform() * Eigen::Vector3d(0.0, 0.0, -0.2);
  EXPECT_EQ(arm.command({1.0, away}), IkStatus::kUnreachable);
  EXPECT_EQ(arm.command({2.0, rest}), IkStatus::kOk);
  EXPECT_EQ(arm.command({1.5, rest}), IkStatus::kInvalidInput) << "stamp runs backwards";
  arm.advanceTo(3.0);
  EXPECT_LT((arm.toolPose().p - rest.p).norm(), 1e-9);
  EXPECT_EQ(arm.commandCounts()[static_cast<std::size_t>(IkStatus::kInvalidInput)], 3u);
  EXPECT_THROW(arm.reset(0.0, JointVector::Zero(3)), InvalidInput);
}

// A pose beyond a limit is followed as far as the limit goes.
TEST(SimulatedArm, StopsAtJointLimits) {
  const SimulationConfig config = shippedSimulation("nominal");
  SimulatedArm arm(config, 1.0);
  JointVector q = config.robot.home();
  const int shoulder = config.robot.indexOf("shoulder");
  q(config.robot.indexOf("insertion")) = -0.12;
  q(shoulder) = config.robot.upper()(shoulder) + 0.2;
  EXPECT_EQ(arm.command({1.0, config.robot.forward(q)}), IkStatus::kOutsideLimits);
  arm.advanceTo(1.1);
  EXPECT_EQ(arm.joints()(shoulder), config.robot.upper()(shoulder));
}

// Nothing knows the Raven: another robot file is another simulated robot.
TEST(SimulatedArm, AnyRobotCanBeSimulated) {
  SimulationConfig config;
  config.name = "psm";
  config.robot = loadKinematicChain("config/robots/psm.yaml");
  for (const std::string& name : effectNames()) config.set(makeEffect(name, config.robot));
  config.set(effectWith("backlash", config.robot, {{"w[pitch]", 0.02}}));
  SimulatedArm arm(config, 0.0);
  JointVector q = config.robot.home() + 0.1 * JointVector::Unit(6, 0);
  q += 0.2 * JointVector::Unit(6, 1);
  EXPECT_EQ(arm.command({0.1, config.robot.forward(q)}), IkStatus::kOk);
  arm.advanceTo(0.2);
  const JointVector expected = q - 0.01 * JointVector::Unit(6, 1);
  EXPECT_LT((arm.joints() - expected).cwiseAbs().maxCoeff(), 1e-9);
  EXPECT_LT((arm.motorJoints() - q).cwiseAbs().maxCoeff(), 1e-9);
}

}  // namespace
}  // namespace raven_correction
