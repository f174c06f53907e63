// SPDX-License-Identifier: BSD-3-Clause
// The way back through the arm: what it says is fed to the simulated arm, whose tool then has to be
// where it was wanted, effect by effect.
#include "raven_correction/simulation/inverse_arm.h"

#include <gtest/gtest.h>

#include <cmath>

#include "raven_correction/error.h"
#include "raven_correction/simulation/session.h"
#include "simulation/simulations.h"
#include "support/allocation_guard.h"

namespace raven_correction {
namespace {

constexpr double kDelay = 0.15;    // of the model: the command of so long before the pose [s]
constexpr double kPeriod = 0.005;  // of the desired poses [s]
constexpr double kSettled = 0.6;   // after the start of a motion: plays have found their side [s]

/// Motions of the debridement task, sampled evenly.
std::vector<PoseStream> desiredMotions() {
  SimulationConfig config = shippedSimulation("nominal");
  std::vector<PoseStream> motions;
  for (const Trajectory& trajectory : simulateSession(config, 4, 7).trajectories) {
    PoseStream motion;
    const double end = trajectory.commands.back().stamp;
    for (double t = trajectory.commands.front().stamp; t < end; t += kPeriod)
      motion.push_back({t, *poseAt(trajectory.commands, t, 1.0)});
    motions.push_back(std::move(motion));
  }
  return motions;
}

struct Error {
  double position = 0.0, angle = 0.0;  // RMS [m, rad]
};

/// The path of a motion up to its sample i, with the corners that a correction has.
ToolPath pathTo(const PoseStream& motion, std::size_t i) {
  ToolPath path;
  for (const double ago : {0.0, 0.05, 0.15, 0.4}) {
    const double instant = std::max(motion.front().stamp, motion[i].stamp - ago);
    path.corners[path.count++] = {ago, *poseAt(motion, instant, 1.0)};
  }
  return path;
}

/// How far the simulated tool is from where it was wanted, with the command of the way back, or
/// with the desired pose itself as command.
Error errorOf(SimulationConfig config, bool inverse) {
  config.setpoints = SetpointMode::kLinear;
  const InverseArm back(config, {kDelay, 0.0, 100.0});
  Error sum;
  double count = 0.0;
  for (const PoseStream& desired : desiredMotions()) {
    SimulatedArm arm(config);
    PoseStream commands;
    for (std::size_t i = 0; i < desired.size(); ++i) {
      const InverseArm::Answer answer = back.solve(pathTo(desired, i));
      EXPECT_TRUE(answer.reached);
      commands.push_back({desired[i].stamp - kDelay, inverse ? answer.command : desired[i].pose});
    }
    arm.reset(commands.front().stamp, commands.front().pose);
    std::size_t next = 0;
    for (const StampedPose& pose : desired) {
      while (next < commands.size() && (next == 0 || commands[next - 1].stamp <= pose.stamp))
        arm.command(commands[next++]);
      arm.advanceTo(pose.stamp);
      if (pose.stamp < desired.front().stamp + kSettled) continue;
      const Pose tool = arm.toolPose();
      sum.position += (tool.p - pose.pose.p).squaredNorm();
      sum.angle += std::pow(rotationAngle(tool.q, pose.pose.q), 2);
      count += 1.0;
    }
  }
  return {std::sqrt(sum.position / count), std::sqrt(sum.angle / count)};
}

SimulationConfig with(const char* effect,
                      std::initializer_list<std::pair<const char*, double>> values) {
  SimulationConfig config = simulationWith(effect, values);
  // Something that takes the rest of the model's delay, so that the arm is on time.
  config.set(effectWith("command_delay", config.robot, {{"tau", 0.1}}));
  return config;
}

// Without memory: the way back is exact but for the interpolation between samples.
TEST(InverseArm, UndoesWhatDoesNotDependOnThePast) {
  const SimulationConfig all[] = {
      with("joint_offset", {{"d[elbow]", 0.05}, {"d[insertion]", 0.004}}),
      with("joint_gain", {{"g[shoulder]", 0.04}, {"g[tool_roll]", -0.1}}),
      with("joint_coupling", {{"c[tool_roll<-insertion]", -8.0}, {"c[elbow<-shoulder]", 0.1}}),
      with("pulley_eccentricity", {{"A[elbow]", 0.01}, {"N[elbow]", 12.0}, {"phi[elbow]", 0.4}}),
      with("cable_stretch", {{"s[elbow]", 0.05}}),
      with("creep", {{"a[shoulder]", 0.03}}),
      with("link_geometry", {{"alpha[elbow]", 0.03}, {"a[wrist_pitch]", 0.002}}),
      with("base_registration", {{"x", 0.01}, {"rz", 0.1}}),
      with("tool_offset", {{"y", 0.006}, {"rx", 0.2}}),
      with("mocap_scale", {{"s", 0.05}}),
      with("registration_shift", {{"t0", 0.0}, {"x", 0.01}, {"ry", 0.05}}),
  };
  for (const SimulationConfig& config : all) {
    const Error without = errorOf(config, false), with_it = errorOf(config, true);
    const std::string name = config.effects.back()->name();
    EXPECT_GT(without.position, 1e-3) << name;  // lag of the delay's rest included
    EXPECT_LT(with_it.position, 3e-5) << name;
    EXPECT_LT(with_it.angle, 1e-3) << name;
  }
}

// The way back sees a pose and its twist: what is left of a lag T is of second order, T^2 times an
// acceleration that it does not know.
TEST(InverseArm, UndoesDelayAndLag) {
  const SimulationConfig config =
      with("tracking_lag", {{"T[shoulder]", 0.03}, {"T[elbow]", 0.05}, {"T[insertion]", 0.04}});
  const Error without = errorOf(config, false), with_it = errorOf(config, true);
  EXPECT_LT(with_it.position, 0.3 * without.position);
  EXPECT_LT(with_it.position, 2e-4);
}

// A roll motor that lags behind the insertion drags the tool round; the way back leads it.
TEST(InverseArm, UndoesTheLagOfAMotorThatTurnsWithAnotherJoint) {
  const SimulationConfig config = with("motor_saturation", {{"T[tool_roll]", 0.02}});
  const Error without = errorOf(config, false), with_it = errorOf(config, true);
  EXPECT_GT(without.angle, 0.05);
  EXPECT_LT(with_it.angle, 0.1 * without.angle);
}

// A play is known only after it has been passed: the way back cannot be exact at a reversal.
TEST(InverseArm, UndoesPlaysWhereTheDirectionIsKnown) {
  for (const char* const effect : {"backlash", "drive_friction"}) {
    const SimulationConfig config =
        with(effect, {{"w[shoulder]", 0.02}, {"w[elbow]", 0.03}, {"w[insertion]", 0.002}});
    const Error without = errorOf(config, false), with_it = errorOf(config, true);
    EXPECT_LT(with_it.position, 0.6 * without.position) << effect;
    EXPECT_LT(with_it.position, 1.2e-3) << effect;
  }
}

TEST(InverseArm, ANominalSimulationGivesThePoseBack) {
  const InverseArm back(shippedSimulation("nominal"), {0.0, 0.0, 0.0});
  const PoseStream motion = desiredMotions().front();
  for (std::size_t i = 0; i < motion.size(); ++i) {
    const InverseArm::Answer answer = back.solve(pathTo(motion, i));
    ASSERT_TRUE(answer.reached);
    EXPECT_LT((answer.command.p - motion[i].pose.p).norm(), 1e-8);
    EXPECT_LT(rotationAngle(answer.command.q, motion[i].pose.q), 1e-6);
  }
}

// At rest for long, no play has a side: the answer is that of a path of one corner.
TEST(InverseArm, AtRestThePathDoesNotMatter) {
  const InverseArm back(shippedSimulation("raven2_left_case2014"), {kDelay, 0.01, 100.0});
  ToolPath path;
  path.count = 4;
  for (std::size_t c = 0; c < 4; ++c)
    path.corners[c] = {0.1 * static_cast<double>(c), desiredMotions().front()[300].pose};
  const InverseArm::Answer rest = back.solve(path);
  path.count = 1;
  const InverseArm::Answer alone = back.solve(path);
  ASSERT_TRUE(rest.reached && alone.reached);
  EXPECT_LT((rest.command.p - alone.command.p).norm(), 1e-9);
}

TEST(InverseArm, SaysWhatItDoesNotReach) {
  const InverseArm back(shippedSimulation("raven2_left_case2014"), {kDelay, 0.01, 100.0});
  ToolPath path = pathTo(desiredMotions().front(), 200);
  ASSERT_TRUE(back.solve(path).reached);
  // The shaft cannot lie on the first axis, which is -x of the base.
  path.corners[2].pose.p = {-0.15, 0.0, 0.0};
  EXPECT_FALSE(back.solve(path).reached);
  path.corners[2].pose.p.setConstant(std::nan(""));
  EXPECT_FALSE(back.solve(path).reached);
  path.count = 0;
  EXPECT_FALSE(back.solve(path).reached);
}

TEST(InverseArm, DoesNotAllocate) {
  for (const char* const name :
       {"raven2_left_case2014", "effect_link_geometry", "effect_cable_stretch"}) {
    const InverseArm back(shippedSimulation(name), {kDelay, 0.01, 100.0});
    const PoseStream motion = desiredMotions().front();
    const ToolPath path = pathTo(motion, 200);
    int allocations = 0;
    {
      const AllocationGuard guard;
      for (int round = 0; round < 100; ++round) back.solve(path);
      allocations = guard.count();
    }
    EXPECT_EQ(allocations, 0) << name;
  }
}

TEST(InverseArm, RefusesTimesThatCannotBe) {
  const SimulationConfig config = shippedSimulation("nominal");
  EXPECT_THROW(InverseArm(config, {std::nan(""), 0.0, 0.0}), InvalidInput);
  EXPECT_THROW(InverseArm(config, {0.1, -0.01, 0.0}), InvalidInput);
  EXPECT_THROW(InverseArm(config, {0.1, 0.0, -1.0}), InvalidInput);
  EXPECT_THROW(InverseArm(SimulationConfig(), {0.1, 0.0, 0.0}), InvalidInput);
}

}  // namespace
}  // namespace raven_correction
