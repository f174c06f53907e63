// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include "raven_correction/dataset/dataset_directory.h"
#include "raven_correction/error.h"
#include "raven_correction/evaluation/error_metrics.h"
#include "raven_correction/evaluation/table_one.h"
#include "raven_correction/evaluation/validated_training.h"
#include "raven_correction/evaluation/visits.h"
#include "raven_correction/simulation/session.h"
#include "support/random_poses.h"
#include "support/test_data.h"

namespace raven_correction {
namespace {

TEST(PoseError, SeparatesPositionAndOrientation) {
  const Pose predicted{{0.1, 0.2, 0.3}, expRotation({0.0, 0.0, M_PI / 2.0})};
  const Pose truth{{0.101, 0.2, 0.3}, predicted.q * expRotation({0.0, 0.0, 0.1})};
  const PoseError error = poseError(predicted, truth);
  EXPECT_NEAR(error.components(0), 0.001, 1e-15);  // in the base frame
  EXPECT_NEAR(error.position_in_tool.y(), -0.001, 1e-15);
  EXPECT_NEAR(error.components(3), 0.1, 1e-14);  // yaw
  EXPECT_NEAR(error.angle, 0.1, 1e-14);
}

TEST(Summarise, NormsAreOfTheMeans) {
  std::vector<PoseError> errors(2);
  errors[0].components << 0.003, -0.004, 0.0, 0.1, 0.0, 0.0;
  errors[1].components << -0.001, 0.0, 0.0, -0.3, 0.0, 0.0;
  const ErrorSummary summary = summarise(errors);
  EXPECT_EQ(summary.n, 2u);
  EXPECT_NEAR(summary.mean_abs(0), 0.002, 1e-15);
  EXPECT_NEAR(summary.std(0), std::sqrt(2.0) * 0.001, 1e-15);
  EXPECT_NEAR(summary.position_norm, std::hypot(0.002, 0.002), 1e-15);
  EXPECT_NEAR(summary.angle_norm, 0.2, 1e-15);
  EXPECT_NEAR(summary.position_median, 0.003, 1e-15);
}

TEST(Summarise, CountsWhatThePredictedIntervalsCover) {
  std::vector<PoseError> errors(4);
  const double residuals[4] = {0.001, -0.0039, 0.0040,
                               0.0};  // deviation 0.002: 1.96 of it is 0.00392
  for (std::size_t i = 0; i < 4; ++i) {
    errors[i].residual.setConstant(residuals[i]);
    errors[i].deviation.setConstant(0.002);
  }
  const ErrorSummary summary = summarise(errors);
  EXPECT_DOUBLE_EQ(summary.coverage95(0), 0.75);
  double squares = 0.0;
  for (const double residual : residuals) squares += std::pow(residual / 0.002, 2) / 4.0;
  EXPECT_NEAR(summary.nlpd(5), std::log(0.002 * std::sqrt(2.0 * M_PI)) + 0.5 * squares, 1e-12);
  EXPECT_DOUBLE_EQ(meanOf({summary, summary}).coverage95(3), 0.75);
  errors[2].deviation(4) = 0.0;  // nothing was predicted: nothing is claimed
  EXPECT_TRUE(std::isnan(summarise(errors).coverage95(0)));
}

TEST(Visits, AreMeasuredAtRestAndOutliersDoNotCount) {
  Pose target{{0.01, 0.02, 0.03}, expRotation({0.1, 0.0, 0.0})};
  PoseStream observations;
  for (int i = 0; i < 100; ++i) {
    Pose seen = target;
    seen.p.x() += i < 60 ? 0.5 : 0.002;  // still moving, then at rest
    if (i == 80) seen.p.x() += 1.0;      // one marker jump
    observations.push_back({0.01 * i, seen});
  }
  const Visit visit = measureVisit("t0", target, observations, 0.99, 0.295);
  EXPECT_EQ(visit.samples, 30u);
  EXPECT_NEAR(visit.error.components(0), -0.002, 1e-12);
  Visit moved = visit;
  moved.target.p.x() += 1e-3;
  EXPECT_THROW(compareVisits({visit}, {moved}), InvalidInput);
  moved = visit;
  moved.name = "other";
  EXPECT_THROW(compareVisits({visit}, {moved}), InvalidInput);
  EXPECT_EQ(compareVisits({visit}, {visit}).before.size(), 1u);
}

TrainingConfig quickConfig() {
  TrainingConfig config = loadTrainingConfig("config/trainer.yaml");
  config.process.max_hyper_points = 200;
  config.process.max_exact_points = 600;
  config.process.exact_variance_points = 200;
  return config;
}

Dataset simulated(int trajectories) {
  return simulateSession(loadSimulationConfig("config/simulation/raven2_left_case2014.yaml"),
                         trajectories, 7);
}

TEST(ValidatedTraining, HoldsTheSameTrajectoriesOutEveryTime) {
  const Dataset dataset = simulated(25);
  int held_out = 0;
  for (const Trajectory& trajectory : dataset.trajectories) held_out += isHeldOut(trajectory);
  EXPECT_GT(held_out, 0);
  EXPECT_LT(held_out, 15);
  const ValidatedTraining first = trainAndValidate(dataset, quickConfig(), nullptr, 1.0);
  EXPECT_EQ(first.held_out_trajectories, static_cast<std::size_t>(held_out));
  EXPECT_TRUE(first.better) << first.verdict;
  EXPECT_LT(first.full.position_norm, 0.25 * first.none.position_norm) << first.verdict;
  // A model that knows less is not better than the one in use.
  TrainingConfig worse = quickConfig();
  worse.process_enabled = false;
  const ValidatedTraining second = trainAndValidate(dataset, worse, &first.training.model, 2.0);
  EXPECT_FALSE(second.better) << second.verdict;
  EXPECT_THROW(trainAndValidate(simulated(2), quickConfig(), nullptr, 1.0), InvalidInput);
}

// A simulation that has seen what validates the model proves nothing: it does not go live.
TEST(ValidatedTraining, DoesNotCountWhatTheSimulationWasFittedTo) {
  const Dataset dataset = simulated(25);
  const ValidationSplit split = splitForValidation(dataset);
  ASSERT_FALSE(split.held_out.trajectories.empty());
  EXPECT_EQ(split.training.trajectories.size() + split.held_out.trajectories.size(), 25u);
  const auto validated = [&](const std::vector<const Dataset*>& fitted_to) {
    SimulationConfig simulation =
        loadSimulationConfig("config/simulation/raven2_left_case2014.yaml");
    for (const Dataset* seen : fitted_to)
      for (const Trajectory& trajectory : seen->trajectories)
        simulation.fitted_to.push_back(trajectory.start() + 1e-6);  // rounded in a file
    TrainingConfig config = quickConfig();
    config.simulation = std::make_shared<const SimulationConfig>(std::move(simulation));
    return trainAndValidate(dataset, config, nullptr, 1.0);
  };
  const ValidatedTraining fair = validated({&split.training});
  EXPECT_TRUE(fair.better) << fair.verdict;
  EXPECT_TRUE(fair.overlap->independent());
  EXPECT_EQ(fair.verdict.find("fitted"), std::string::npos) << fair.verdict;
  const ValidatedTraining leaks = validated({&split.training, &split.held_out});
  EXPECT_FALSE(leaks.better) << leaks.verdict;
  EXPECT_EQ(leaks.overlap->seen, split.held_out.trajectories.size());
  EXPECT_NE(leaks.verdict.find("leave_out_validation"), std::string::npos) << leaks.verdict;
  const ValidatedTraining unknown = validated({});
  EXPECT_TRUE(unknown.better) << unknown.verdict;
  EXPECT_NE(unknown.verdict.find("is not known"), std::string::npos) << unknown.verdict;
  EXPECT_FALSE(trainAndValidate(dataset, quickConfig(), nullptr, 1.0).overlap.has_value());
}

TEST(TableOne, OrdersTheMethodsOnASimulatedSession) {
  TableOneProblem problem;
  problem.configurations = {{"best", quickConfig()}};
  const TableOneResult result = crossValidate(simulated(30), problem);
  EXPECT_EQ(result.rows.size(), 6u * 2u * 6u);
  const auto norm = [&](Method method) {
    return result.row("best", method, true, kMeanOfFolds).errors.position_norm;
  };
  EXPECT_LT(norm(Method::kRigidClean), norm(Method::kNone));
  EXPECT_LT(norm(Method::kRigidGp), norm(Method::kRigidClean));
  EXPECT_LT(norm(Method::kRigidGpVelocityClean), norm(Method::kRigidGp));
  EXPECT_EQ(
      result.fates.total(), result.fates[Fate::kKept] + [&] {
        std::size_t rejected = 0;
        for (std::size_t i = 1; i < result.fates.count.size(); ++i)
          rejected += result.fates.count[i];
        return rejected;
      }());
}

// A simulation may have seen what a fold tests on, and no column of the table says "physics".
TEST(TableOne, HasNoPhysicsInAnyMethod) {
  TrainingConfig config = quickConfig();
  config.simulation = std::make_shared<const SimulationConfig>(
      loadSimulationConfig("config/simulation/raven2_left_case2014.yaml"));
  for (int method = 0; method < static_cast<int>(Method::kCount); ++method)
    EXPECT_EQ(configOf(static_cast<Method>(method), config).simulation, nullptr)
        << methodName(static_cast<Method>(method));
}

TEST(TableOne, NeedsAsManyTrajectoriesAsFolds) {
  TableOneProblem problem;
  problem.configurations = {{"best", quickConfig()}};
  try {
    crossValidate(simulated(4), problem);
    FAIL();
  } catch (const InvalidInput& error) {
    EXPECT_NE(std::string(error.what()).find("at least 5"), std::string::npos) << error.what();
  }
}

TEST(TableOne, TheMeasuredSessionIsCorrectedToOneAndAHalfMillimetres) {
  const std::string path = testData("case2014_left/dataset.yaml");
  RAVEN_SKIP_WITHOUT_DATA(path, "case2014_left");
  const Dataset dataset = readDatasetDirectory(path.substr(0, path.rfind('/')));
  TableOneProblem problem;
  problem.configurations = {{"best", loadTrainingConfig("config/trainer.yaml")}};
  const TableOneResult result = crossValidate(dataset, problem);
  const ErrorSummary& none = result.row("best", Method::kNone, true, kMeanOfFolds).errors;
  const ErrorSummary& full =
      result.row("best", Method::kRigidGpVelocityClean, true, kMeanOfFolds).errors;
  EXPECT_NEAR(1e3 * none.position_norm, 26.4, 0.3);  // as others measured on this session
  EXPECT_LE(1e3 * full.position_norm, 1.5);
  EXPECT_LE(full.angle_norm * 180.0 / M_PI, 1.5);
  for (Eigen::Index k = 0; k < 6; ++k) {
    EXPECT_GE(full.coverage95(k), 0.92) << k;
    EXPECT_LE(full.coverage95(k), 0.98) << k;
  }
  EXPECT_TRUE(std::isnan(none.coverage95(0)));
  EXPECT_NEAR(result.delay, 0.16, 0.02);
  EXPECT_EQ(result.identity_commands, 346u);  // counted in the README of the data set
  EXPECT_EQ(result.fates.total(), 26274u);
}

}  // namespace
}  // namespace raven_correction
