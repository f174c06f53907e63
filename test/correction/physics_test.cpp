// SPDX-License-Identifier: BSD-3-Clause
// Physics as the mean: what training makes of a simulation, that the live path says the same as
// training and prediction, and which simulations are refused.
#include "raven_correction/correction/physics.h"

#include <gtest/gtest.h>

#include "raven_correction/correction/corrector.h"
#include "raven_correction/correction/training.h"
#include "raven_correction/error.h"
#include "raven_correction/simulation/effect_registry.h"
#include "raven_correction/simulation/session.h"

namespace raven_correction {
namespace {

const SimulationConfig& robot() {
  static const SimulationConfig config =
      loadSimulationConfig("config/simulation/raven2_left_case2014.yaml");
  return config;
}

const Dataset& session() {
  static const Dataset dataset = simulateSession(robot(), 12, 3);
  return dataset;
}

TrainingConfig quick(bool physics) {
  TrainingConfig config;
  config.process.max_hyper_points = 150;
  config.process.inducing_points = 80;
  config.process.groups = {{0, 1, 2}, {3, 4, 5}};
  if (physics) config.simulation = std::make_shared<const SimulationConfig>(robot());
  return config;
}

TEST(Physics, OfTheRobotItselfLeavesLessThanTheRigidStep) {
  const TrainingResult result = train(session(), quick(true), 1.0);
  EXPECT_EQ(result.simulation, robot().name);
  EXPECT_LT(result.physics_rms_position, 0.5 * result.rigid_rms_position);
  EXPECT_LT(result.physics_rms_angle, result.rigid_rms_angle);
  EXPECT_LT(result.out_of_reach, result.model.training_pairs / 20);
  EXPECT_FALSE(result.model.physics.empty());
  EXPECT_GT(result.model.physics.timing.hold, 0.005);
  EXPECT_GT(result.model.physics.timing.age, 20.0);
  EXPECT_EQ(result.model.physics.timing.delay, result.model.delay);
}

// Of a robot that stands a little off, some observed poses are out of reach: these are not counted
// as learnt from.
TEST(Physics, CountsThePairsThatAreLearntFrom) {
  SimulationConfig off = robot();
  off.set(makeEffect("base_registration", off.robot));
  TrainingConfig config = quick(false);
  std::size_t out_of_reach = 0;
  for (const double shift : {0.04, -0.04, 0.06, -0.06, 0.08, -0.08, 0.1, -0.1}) {  // up and down
    if (out_of_reach > 0) break;
    std::unique_ptr<Effect> effect = makeEffect("base_registration", off.robot);
    effect->setValue(2, shift);
    off.set(std::move(effect));
    config.simulation = std::make_shared<const SimulationConfig>(off);
    const TrainingResult result = train(session(), config, 1.0);
    out_of_reach = result.out_of_reach;
    EXPECT_EQ(result.model.training_pairs, result.fates[Fate::kKept] - result.out_of_reach);
    EXPECT_EQ(result.process.rows, static_cast<int>(result.model.training_pairs));
  }
  EXPECT_GT(out_of_reach, 0u);
}

// What was recorded a day before does not make the robot a day older.
TEST(Physics, TheAgeIsThatOfTheLastSession) {
  constexpr double kDay = 86400.0;
  Dataset days = session();
  for (std::size_t i = 4; i < days.trajectories.size(); ++i)
    for (PoseStream* stream : {&days.trajectories[i].commands, &days.trajectories[i].observations,
                               &days.trajectories[i].encoders})
      for (StampedPose& sample : *stream) sample.stamp += kDay;
  const double start = days.trajectories[4].commands.front().stamp;
  const double age = physicsOf(robot(), days, 0.1).timing.age;
  EXPECT_NEAR(age, days.trajectories.back().commands.back().stamp - start, 1e-9);
  EXPECT_LT(age, 0.01 * kDay);
}

TEST(Physics, WithoutASimulationNothingChanges) {
  const TrainingResult result = train(session(), quick(false), 1.0);
  EXPECT_TRUE(result.model.physics.empty());
  EXPECT_TRUE(result.simulation.empty());
  EXPECT_FALSE(inverseArmOf(result.model.physics).has_value());
  const Predictor predictor(result.model);
  const auto workspace = predictor.makeWorkspace();
  Motion motion;
  motion.pose = session().trajectories[2].observations[40].pose;
  const Prediction prediction = predictor.predict(motion, *workspace);
  EXPECT_EQ(prediction.mean.p, prediction.rigid.p);
  EXPECT_EQ(prediction.status, Prediction::Status::kFull);
}

// The path of a motion is the motion: where the tool was when each interval began.
TEST(Physics, ThePathIsThatOfTheMotion) {
  const MotionOptions options;
  MotionEstimator estimator(options);
  const auto pose = [](double t) {
    return Pose{{0.1 * t, 0.02, -0.1}, expRotation({0.0, 0.3 * t, 0.0})};
  };
  for (double t = 0.0; t < 1.0; t += 0.01) estimator.push(10.0 + t, pose(t));
  const double now = 0.99;
  const ToolPath path = pathOf(estimator.motion(), options);
  ASSERT_EQ(path.count, 4u);
  for (std::size_t c = 0; c < path.count; ++c) {
    const Pose there = pose(now - path.corners[c].ago);
    EXPECT_LT((path.corners[c].pose.p - there.p).norm(), 1e-9);
    EXPECT_LT(rotationAngle(path.corners[c].pose.q, there.q), 1e-9);
  }
  EXPECT_EQ(path.corners[3].ago, 0.4);
  MotionOptions none;
  none.velocity = VelocityKind::kNone;
  EXPECT_EQ(pathOf(estimator.motion(), none).count, 1u);
}

// A model that was read back as text says live, to the bit, what training was told.
TEST(Physics, TrainingAndLiveSayTheSameToTheBit) {
  TrainingConfig config = quick(true);
  config.process_enabled = false;
  const Correction model = train(session(), config, 1.0).model;
  const InverseArm told(robot(), model.physics.timing);
  const Predictor live(model);
  const auto workspace = live.makeWorkspace();
  const TrainingPairs pairs = makePairs(session(), config, model.delay);
  std::size_t reached = 0;
  for (const Motion& motion : pairs.motions) {
    const InverseArm::Answer answer = told.solve(pathOf(motion, config.motion));
    const Prediction prediction = live.predict(motion, *workspace);
    if (!answer.reached) continue;
    ASSERT_EQ(prediction.mean.p, answer.command.p);
    ASSERT_EQ(prediction.mean.q.coeffs(), answer.command.q.coeffs());
    ++reached;
  }
  EXPECT_GT(reached, pairs.motions.size() / 2);
}

TEST(Physics, TheCorrectorFollowsTheSimulation) {
  const Correction model = train(session(), quick(true), 1.0).model;
  CorrectorLimits limits;
  limits.max_translation = 0.2;
  limits.max_rotation = 3.0;
  limits.max_translation_rate = 10.0;
  limits.max_rotation_rate = 100.0;
  Corrector corrector(limits);
  corrector.setModel(model);
  corrector.setMode(CorrectorMode::kFull);
  const Predictor predictor(model);
  const auto workspace = predictor.makeWorkspace();
  MotionEstimator estimator(model.motion);
  const PoseStream& wanted = session().trajectories[5].commands;
  int corrected = 0;
  for (const StampedPose& desired : wanted) {
    const CorrectorOutput output =
        corrector.correct(desired.stamp, desired.stamp, desired.pose, false);
    estimator.push(desired.stamp, desired.pose);
    const Prediction expected = predictor.predict(estimator.motion(), *workspace);
    if (output.code != CorrectorCode::kCorrected) continue;
    EXPECT_LT((output.command.p - expected.command.p).norm(), 1e-12);
    EXPECT_LT(rotationAngle(output.command.q, expected.command.q), 1e-12);
    ++corrected;
  }
  EXPECT_GT(corrected, static_cast<int>(wanted.size()) / 2);
}

TEST(Physics, WhereItDoesNotReachTheRigidStepAloneRemains) {
  const Correction model = train(session(), quick(true), 1.0).model;
  const Predictor predictor(model);
  const auto workspace = predictor.makeWorkspace();
  Motion motion;
  motion.pose = session().trajectories[2].observations[40].pose;
  ASSERT_EQ(predictor.predict(motion, *workspace).status, Prediction::Status::kFull);
  motion.twists[2].v.x() = 10.0;  // it came from where no robot was
  const Prediction prediction = predictor.predict(motion, *workspace);
  EXPECT_EQ(prediction.status, Prediction::Status::kFaded);
  EXPECT_EQ(prediction.h_share, 0.0);
  EXPECT_LT((prediction.command.p - (model.rigid * motion.pose).p).norm(), 1e-12);
}

std::string complaint(const Dataset& dataset, const SimulationConfig& simulation) {
  TrainingConfig config = quick(false);
  config.simulation = std::make_shared<const SimulationConfig>(simulation);
  try {
    train(dataset, config, 1.0);
  } catch (const InvalidInput& error) {
    return error.what();
  }
  return "accepted";
}

TEST(Physics, OfAnotherRobotIsRefused) {
  const SimulationConfig right = loadSimulationConfig("config/simulation/raven2_right.yaml");
  const std::string why = complaint(session(), right);
  EXPECT_NE(why.find("raven2_left"), std::string::npos) << why;
  EXPECT_NE(why.find("raven2_right"), std::string::npos) << why;
  Dataset words = session();
  words.arm = "Raven II, left (gold) arm";
  EXPECT_EQ(complaint(words, robot()), "accepted");
  EXPECT_NE(complaint(words, right), "accepted");
  Dataset elsewhere = session();
  elsewhere.frame = "camera";
  EXPECT_NE(complaint(elsewhere, robot()).find("camera"), std::string::npos);
}

TEST(Physics, TextsOfASimulationReadBackToTheSameOne) {
  const SimulationTexts texts = simulationTexts(robot());
  const SimulationConfig read = simulationFromTexts(texts, "model");
  EXPECT_EQ(parameterVector(read), parameterVector(robot()));
  EXPECT_EQ(simulationTexts(robot()).simulation, texts.simulation);
  EXPECT_EQ(read.robot.name(), robot().robot.name());
  EXPECT_EQ(read.setpoints, robot().setpoints);
  EXPECT_EQ(read.coupling.empty(), robot().coupling.empty());
  EXPECT_THROW(simulationFromTexts({texts.simulation, "name: nobody"}, "model"), InvalidInput);
  EXPECT_THROW(simulationFromTexts({"- a list", texts.robot}, "model"), InvalidInput);
}

TEST(Physics, FewerPairsAreDrawnFromTheSameOnes) {
  TrainingConfig config = quick(false);
  config.process_enabled = false;
  const std::size_t all = train(session(), config, 1.0).model.training_pairs;
  config.max_pairs = 60;
  const Correction pairs = train(session(), config, 1.0).model;
  EXPECT_EQ(pairs.training_pairs, 60u);
  EXPECT_GT(pairs.training_trajectories, 8u);
  config.draw = TrainingConfig::Draw::kTrajectories;
  const Correction whole = train(session(), config, 1.0).model;
  EXPECT_EQ(whole.training_pairs, 60u);
  EXPECT_LT(whole.training_trajectories, 3u);
  config.max_pairs = 2 * all;
  EXPECT_EQ(train(session(), config, 1.0).model.training_pairs, all);
}

}  // namespace
}  // namespace raven_correction
