// SPDX-License-Identifier: BSD-3-Clause
#include "raven_correction/evaluation/learning_curve.h"

#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "raven_correction/error.h"
#include "raven_correction/report/learning_curve_report.h"
#include "raven_correction/simulation/session.h"

namespace raven_correction {
namespace {

const SimulationConfig& robot() {
  static const SimulationConfig config =
      loadSimulationConfig("config/simulation/raven2_left_case2014.yaml");
  return config;
}

LearningCurveProblem quick(const SimulationConfig& simulation) {
  LearningCurveProblem problem;
  problem.config.process.max_hyper_points = 120;
  problem.config.process.groups = {{0, 1, 2}, {3, 4, 5}};
  problem.config.process.backend = GpBackend::kExact;
  problem.simulations = {std::make_shared<const SimulationConfig>(simulation)};
  problem.pairs = {40, 200};
  problem.folds = 4;
  problem.only_folds = {0, 2};
  problem.resamples = 200;
  return problem;
}

const LearningCurveRow& rowOf(const LearningCurveResult& result, CurveMethod method,
                              std::size_t pairs) {
  for (const LearningCurveRow& row : result.rows)
    if (row.method == method && row.pairs == pairs) return row;
  throw InvalidInput("no such row");
}

// A robot that errs as the simulation says needs fewer pairs than regression alone, though not many
// fewer: play and friction hide from the way back what they hide from the process.
TEST(LearningCurve, TheTruthSavesPairs) {
  const Dataset dataset = simulateSession(robot(), 16, 3);
  const LearningCurveResult result = learningCurve(dataset, quick(robot()));
  ASSERT_EQ(result.rows.size(), 7u);
  const ErrorSummary& none = rowOf(result, CurveMethod::kNone, 0).errors;
  const ErrorSummary& physics = rowOf(result, CurveMethod::kPhysics, 0).errors;
  const ErrorSummary& few = rowOf(result, CurveMethod::kPhysicsRegression, 40).errors;
  const ErrorSummary& alone = rowOf(result, CurveMethod::kRegression, 40).errors;
  EXPECT_LT(physics.position_norm, 0.2 * none.position_norm);
  EXPECT_LT(few.position_norm, 0.95 * alone.position_norm);
  ASSERT_EQ(result.saved.size(), 2u);
  EXPECT_GT(result.saved[0].position_pairs, 45.0);
  EXPECT_LT(result.saved[0].position_ratio, 1.0);
  EXPECT_LE(result.saved[0].position_lower, result.saved[0].position_ratio);
  EXPECT_EQ(rowOf(result, CurveMethod::kRegression, 40).n_train, 40u);
  EXPECT_EQ(rowOf(result, CurveMethod::kRegression, 40).folds.size(), 2u);
  EXPECT_EQ(result.trajectories, 8u);

  const auto json = nlohmann::json::parse(learningCurveJson(result));
  EXPECT_EQ(json["rows"].size(), 7u);
  EXPECT_EQ(json["rows"][3]["method"], "regression");
  EXPECT_NEAR(json["rows"][3]["position_norm_mm"], 1e3 * alone.position_norm, 1e-9);
  EXPECT_EQ(json["saved"][0]["pairs"], 40);
  EXPECT_NE(learningCurveText(result).find("physics_regression"), std::string::npos);
}

// A simulation without any effect says what the planner said: nothing is gained by it.
TEST(LearningCurve, TheNominalSimulationSavesNone) {
  SimulationConfig nominal = robot();
  nominal.effects.clear();
  const Dataset dataset = simulateSession(robot(), 16, 3);
  const LearningCurveResult result = learningCurve(dataset, quick(nominal));
  EXPECT_GT(result.saved[1].position_ratio, 0.9);
  EXPECT_GT(rowOf(result, CurveMethod::kPhysics, 0).errors.position_norm,
            rowOf(result, CurveMethod::kRigid, 0).errors.position_norm);
}

// The paper's Fig. 5: more states, smaller errors; each number takes some time.
TEST(LearningCurve, NeedsNoSimulation) {
  const Dataset dataset = simulateSession(robot(), 16, 3);
  LearningCurveProblem problem = quick(robot());
  const LearningCurveResult with = learningCurve(dataset, problem);
  problem.simulations.clear();
  const LearningCurveResult without = learningCurve(dataset, problem);
  ASSERT_EQ(without.rows.size(), 4u);
  EXPECT_TRUE(without.saved.empty());
  for (const std::size_t pairs : problem.pairs) {
    const LearningCurveRow& row = rowOf(without, CurveMethod::kRegression, pairs);
    EXPECT_EQ(row.errors.position_norm,
              rowOf(with, CurveMethod::kRegression, pairs).errors.position_norm);
    EXPECT_GT(row.train_seconds, 0.0);
  }
  EXPECT_LT(rowOf(without, CurveMethod::kRegression, 200).errors.position_norm,
            rowOf(without, CurveMethod::kRegression, 40).errors.position_norm);
  EXPECT_LT(rowOf(without, CurveMethod::kRegression, 40).errors.position_norm,
            rowOf(without, CurveMethod::kRigid, 0).errors.position_norm);
}

TEST(LearningCurve, RefusesWhatDoesNotFitTogether) {
  const Dataset dataset = simulateSession(robot(), 5, 3);
  LearningCurveProblem problem = quick(robot());
  problem.pairs = {200, 40};
  EXPECT_THROW(learningCurve(dataset, problem), InvalidInput);
  problem = quick(robot());
  problem.simulations.push_back(problem.simulations.front());
  EXPECT_THROW(learningCurve(dataset, problem), InvalidInput);
  problem = quick(robot());
  problem.folds = 6;
  EXPECT_THROW(learningCurve(dataset, problem), InvalidInput);
  problem = quick(robot());
  problem.only_folds = {4};
  EXPECT_THROW(learningCurve(dataset, problem), InvalidInput);
}

}  // namespace
}  // namespace raven_correction
