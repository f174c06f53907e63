// SPDX-License-Identifier: BSD-3-Clause
// A model is trained on a simulated robot; moves of the same robot pass, those of one that was
// homed anew, has another tool or is the other arm do not.
#include "raven_correction/evaluation/preflight.h"

#include <gtest/gtest.h>

#include "raven_correction/error.h"
#include "raven_correction/evaluation/validated_training.h"
#include "raven_correction/simulation/session.h"
#include "simulation/simulations.h"

namespace raven_correction {
namespace {

using Status = PreflightResult::Status;

TrainingConfig quickConfig() {
  TrainingConfig config;
  config.process.max_hyper_points = 150;
  config.process.max_exact_points = 600;
  config.process.backend = GpBackend::kExact;
  config.process.groups = {{0, 1, 2, 3, 4, 5}};
  return config;
}

/// Trained and validated once for all tests.
const Correction& model() {
  static const Correction trained = [] {
    const Dataset session = simulateSession(shippedSimulation("demo"), 30, 5);
    return trainAndValidate(session, quickConfig(), nullptr, 1e9).training.model;
  }();
  return trained;
}

/// What a pre-flight would see: all moves as one stream.
PreflightResult judge(const Dataset& session, const PreflightLimits& limits = {}) {
  PoseStream commands, observations;
  for (const Trajectory& trajectory : session.trajectories) {
    commands.insert(commands.end(), trajectory.commands.begin(), trajectory.commands.end());
    observations.insert(observations.end(), trajectory.observations.begin(),
                        trajectory.observations.end());
  }
  return judgePreflight(model(), commands, observations, limits);
}

TEST(Preflight, TheRobotThatTheModelIsOfPasses) {
  for (const std::uint64_t seed : {11, 12, 13}) {
    const PreflightResult result = judge(simulateSession(shippedSimulation("demo"), 4, seed));
    EXPECT_EQ(result.status, Status::kPassed) << result.message;
    EXPECT_GT(result.poses, 200u);
    EXPECT_LT(result.position, 0.5 * result.uncorrected_position);
    EXPECT_LE(result.max_position, PreflightLimits().max_position);
    EXPECT_EQ(result.promised_position, model().held_out.position_after);
    std::printf("seed %d: %s\n", static_cast<int>(seed), result.message.c_str());
  }
}

TEST(Preflight, ARobotThatWasHomedAnewFails) {
  SimulationConfig homed = shippedSimulation("demo");
  homed.set(effectWith("joint_offset", homed.robot,
                       {{"d[shoulder]", 0.06}, {"d[elbow]", -0.05}, {"d[insertion]", 0.004}}));
  const PreflightResult result = judge(simulateSession(homed, 4, 11));
  EXPECT_EQ(result.status, Status::kFailed) << result.message;
  EXPECT_NE(result.message.find("not valid for this robot today"), std::string::npos);
}

TEST(Preflight, AnotherRegistrationFails) {
  SimulationConfig moved = shippedSimulation("demo");
  moved.set(effectWith("base_registration", moved.robot, {{"x", 0.03}, {"y", -0.02}}));
  EXPECT_EQ(judge(simulateSession(moved, 4, 11)).status, Status::kFailed);
}

TEST(Preflight, TheOtherArmFails) {
  const PreflightResult result = judge(simulateSession(shippedSimulation("raven2_right"), 4, 11));
  EXPECT_EQ(result.status, Status::kFailed) << result.message;
}

TEST(Preflight, TooFewPosesOrNoMotionProveNothing) {
  Dataset session = simulateSession(shippedSimulation("demo"), 1, 11);
  session.trajectories[0].observations.resize(100);
  EXPECT_EQ(judge(session).status, Status::kNotObserved);
  session = simulateSession(shippedSimulation("demo"), 4, 11);
  for (Trajectory& trajectory : session.trajectories)
    for (StampedPose& command : trajectory.commands)
      command.pose = session.trajectories[0].commands[0].pose;
  const PreflightResult still = judge(session);
  EXPECT_EQ(still.status, Status::kNotObserved) << still.message;
  EXPECT_NE(still.message.find("a few moves"), std::string::npos);
  EXPECT_EQ(judge(Dataset()).status, Status::kNotObserved);
}

TEST(Preflight, LimitsFollowThePromiseUpToTheCeiling) {
  const Dataset moves = simulateSession(shippedSimulation("demo"), 4, 11);
  PreflightLimits limits;
  limits.factor = 0.01;
  limits.least_position = limits.least_angle = 0.0;
  EXPECT_EQ(judge(moves, limits).status, Status::kFailed);
  limits = {};
  limits.max_position = 1e-5;
  const PreflightResult strict = judge(moves, limits);
  EXPECT_EQ(strict.status, Status::kFailed);
  EXPECT_EQ(strict.max_position, 1e-5);
  limits.max_position = 0.0;
  EXPECT_THROW(judge(moves, limits), InvalidInput);
}

TEST(Preflight, AModelThatPromisesNothingHasTheCeiling) {
  Correction silent = model();
  silent.held_out = {};
  const Dataset moves = simulateSession(shippedSimulation("demo"), 4, 11);
  PoseStream commands = moves.trajectories[0].commands;
  PoseStream observations = moves.trajectories[0].observations;
  for (std::size_t k = 1; k < moves.trajectories.size(); ++k) {
    const Trajectory& more = moves.trajectories[k];
    commands.insert(commands.end(), more.commands.begin(), more.commands.end());
    observations.insert(observations.end(), more.observations.begin(), more.observations.end());
  }
  const PreflightResult result = judgePreflight(silent, commands, observations, {});
  EXPECT_EQ(result.max_position, PreflightLimits().max_position);
  EXPECT_NE(result.message.find("promises nothing"), std::string::npos);
}

}  // namespace
}  // namespace raven_correction
