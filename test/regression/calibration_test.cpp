// SPDX-License-Identifier: BSD-3-Clause
// Intervals that are too narrow are widened until they cover what was left out; scores are those of
// their formulae.
#include "raven_correction/regression/calibration.h"

#include <gtest/gtest.h>

#include "raven_correction/error.h"
#include "raven_correction/regression/gp_predictor.h"
#include "raven_correction/regression/regress.h"
#include "sample_problems.h"

namespace raven_correction {
namespace {

TEST(Score, FromTheFormulae) {
  const Eigen::MatrixXd truth = (Eigen::MatrixXd(4, 1) << 0.0, 1.0, 2.0, 3.0).finished();
  const Eigen::MatrixXd mean = (Eigen::MatrixXd(4, 1) << 0.0, 1.0, 2.0, 6.0).finished();
  const Eigen::MatrixXd variance = Eigen::MatrixXd::Ones(4, 1);
  const PredictionScore score = scorePredictions(truth, mean, variance)[0];
  EXPECT_DOUBLE_EQ(score.rmse, 1.5);
  EXPECT_DOUBLE_EQ(score.smse, 2.25 / 1.25);
  EXPECT_NEAR(score.nlpd, 0.5 * std::log(2.0 * M_PI) + 9.0 / 8.0, 1e-12);
  EXPECT_DOUBLE_EQ(score.coverage95, 0.75);
  EXPECT_THROW(scorePredictions(truth, mean.topRows(3), variance), InvalidInput);
}

// Rows of a group share an error, which intervals learnt from single rows do not know.
TEST(Calibration, CoversGroupsThatWereLeftOut) {
  constexpr int kGroups = 60;
  constexpr int kPerGroup = 20;
  Eigen::MatrixXd features(kGroups * kPerGroup, 3);
  Eigen::MatrixXd targets;
  std::vector<int> groups;
  const Eigen::MatrixXd centres = normalMatrix(kGroups, 3, 1);
  const Eigen::MatrixXd offsets = 0.3 * normalMatrix(kGroups, 2, 2);
  features = 0.02 * normalMatrix(features.rows(), 3, 3);
  for (int i = 0; i < kGroups * kPerGroup; ++i) {
    groups.push_back(7 * (i / kPerGroup));
    features.row(i) += centres.row(i / kPerGroup);
  }
  targets = smoothTargets(features);
  for (int i = 0; i < targets.rows(); ++i) targets.row(i) += offsets.row(i / kPerGroup);
  GpConfig config;
  config.groups = {{0, 1}};
  config.inducing_points = 100;
  config.variance_points = 50;
  GpModel model = fitGp(features, targets, config).model;
  for (GpGroup& group : model.groups) {  // far too sure of itself
    group.signal_variance *= 0.04;
    group.noise_variance *= 0.04;
  }
  const CalibrationResult result = calibrate(model, features, targets, groups, 5);
  EXPECT_EQ(result.folds, 5);
  for (int k = 0; k < 2; ++k) {
    EXPECT_LT(result.before[std::size_t(k)].coverage95, 0.9);
    EXPECT_NEAR(result.after[std::size_t(k)].coverage95, 0.95, 0.005);
    EXPECT_LT(result.after[std::size_t(k)].nlpd, result.before[std::size_t(k)].nlpd);
    EXPECT_GT(result.variance_scale(k), 2.0);
  }
  // The scaled model has the same means and scaled variances.
  const GpModel scaled = scaleVariance(model, result.variance_scale);
  Eigen::MatrixXd mean, mean_scaled, variance, variance_scaled;
  GpPredictor(model).predict(features, mean, &variance);
  GpPredictor(scaled).predict(features, mean_scaled, &variance_scaled);
  EXPECT_EQ(mean, mean_scaled);
  EXPECT_LT((variance * result.variance_scale.asDiagonal() - variance_scaled).cwiseAbs().maxCoeff(),
            1e-12);
}

TEST(Calibration, TooFewGroupsCheckNothingAndSayIt) {
  const Eigen::MatrixXd features = normalMatrix(30, 3, 1);
  const Eigen::MatrixXd targets = smoothTargets(features);
  GpConfig config;
  config.inducing_points = 10;
  const GpModel model = fitGp(features, targets, config).model;
  const CalibrationResult result = calibrate(model, features, targets, std::vector<int>(30, 1), 5);
  EXPECT_EQ(result.folds, 0);
  EXPECT_EQ(result.variance_scale, Eigen::VectorXd::Ones(2));
  EXPECT_THROW(calibrate(model, features, targets, std::vector<int>(29, 1), 5), InvalidInput);
}

TEST(Regress, LearnsOneTableAndScoresAnother) {
  RegressProblem problem;
  problem.targets = 2;
  problem.train.resize(300, 5);
  problem.train.leftCols(3) = normalMatrix(300, 3, 1);
  problem.train.rightCols(2) = smoothTargets(problem.train.leftCols(3));
  problem.train.rightCols(2).array() += 50.0;
  problem.test.resize(150, 5);
  problem.test.leftCols(3) = normalMatrix(150, 3, 2);
  problem.test.rightCols(2) = smoothTargets(problem.test.leftCols(3));
  problem.test.rightCols(2).array() += 50.0;
  problem.config.backend = GpBackend::kExact;
  problem.config.kernel = KernelType::kSquaredExponential;
  const RegressResult result = regress(problem);
  ASSERT_EQ(result.outputs.size(), 2u);
  for (const PredictionScore& score : result.outputs) {
    EXPECT_LT(score.smse, 0.01);
    EXPECT_GT(score.coverage95, 0.8);
  }
  EXPECT_EQ(result.n_train, 300);
  EXPECT_EQ(result.n_test, 150);
  EXPECT_GT(result.seconds_hyperparameters, 0.0);
  problem.test.conservativeResize(150, 4);
  EXPECT_THROW(regress(problem), InvalidInput);
  EXPECT_THROW(backendFromName("laplace"), InvalidInput);
  EXPECT_EQ(backendFromName(backendName(GpBackend::kExact)), GpBackend::kExact);
}

}  // namespace
}  // namespace raven_correction
