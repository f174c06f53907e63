// SPDX-License-Identifier: BSD-3-Clause
// The fit as a user meets it: analytic functions, awkward data, and input that is refused.
#include "raven_correction/regression/gaussian_process.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "raven_correction/error.h"
#include "raven_correction/regression/gp_predictor.h"
#include "sample_problems.h"

namespace raven_correction {
namespace {

double rms(const Eigen::MatrixXd& values) {
  return std::sqrt(values.squaredNorm() / double(values.size()));
}

double errorOnNewPoints(const GpFit& fit, Eigen::Index features, unsigned seed) {
  const Eigen::MatrixXd queries = normalMatrix(200, features, seed);
  Eigen::MatrixXd mean;
  GpPredictor(fit.model).predict(queries, mean, nullptr);
  const Eigen::MatrixXd truth = smoothTargets(queries);
  Eigen::MatrixXd error = mean - truth;
  for (Eigen::Index k = 0; k < 2; ++k) error.col(k) /= rms(truth.col(k));
  return rms(error);
}

class Fit : public ::testing::TestWithParam<GpBackend> {};

TEST_P(Fit, InterpolatesAnAnalyticFunctionAtFreshPoints) {
  const Eigen::MatrixXd features = normalMatrix(400, 3, 1);
  GpConfig config;
  config.backend = GetParam();
  config.kernel = KernelType::kSquaredExponential;
  config.inducing_points = 200;
  const GpFit fit = fitGp(features, smoothTargets(features), config);
  EXPECT_LT(errorOnNewPoints(fit, 3, 2), 0.02);
  EXPECT_EQ(fit.report.rows, 400);
  EXPECT_EQ(fit.report.groups.size(), 2u);
}

TEST_P(Fit, TwoDeviationsCoverAboutTheRightShare) {
  int inside = 0;
  int all = 0;
  for (unsigned seed = 0; seed < 5; ++seed) {
    const Eigen::MatrixXd features = normalMatrix(200, 3, 10 + seed);
    const Eigen::MatrixXd targets = smoothTargets(features) + 0.2 * normalMatrix(200, 2, 20 + seed);
    GpConfig config;
    config.backend = GetParam();
    config.inducing_points = 150;
    config.kernel = KernelType::kSquaredExponential;
    const GpFit fit = fitGp(features, targets, config);
    const Eigen::MatrixXd queries = normalMatrix(200, 3, 30 + seed);
    const Eigen::MatrixXd truth = smoothTargets(queries) + 0.2 * normalMatrix(200, 2, 40 + seed);
    Eigen::MatrixXd mean;
    Eigen::MatrixXd variance;
    GpPredictor(fit.model).predict(queries, mean, &variance);
    for (const GpGroup& group : fit.model.groups)
      variance.col(group.outputs[0]).array() += group.noise_variance(0);
    inside += int(((mean - truth).array().square() < 3.8415 * variance.array()).count());
    all += int(mean.size());
  }
  // 2000 draws know a share of 95 % to 0.5 %; correlated through five fits, so twice five of it.
  EXPECT_NEAR(double(inside) / all, 0.95, 0.05);
}

TEST_P(Fit, GroupedOutputsShareLengthScalesAndKeepTheirVariances) {
  const Eigen::MatrixXd features = normalMatrix(200, 3, 3);
  GpConfig config;
  config.backend = GetParam();
  config.groups = {{1, 0}};
  const GpFit fit = fitGp(features, smoothTargets(features), config);
  ASSERT_EQ(fit.model.groups.size(), 1u);
  EXPECT_LT(errorOnNewPoints(fit, 3, 4), 0.15);
  EXPECT_GT(fit.model.groups[0].signal_variance(0), fit.model.groups[0].signal_variance(1));
}

TEST_P(Fit, LinearMeanExtrapolatesAPlane) {
  const Eigen::MatrixXd features = normalMatrix(60, 2, 5);
  Eigen::MatrixXd targets(60, 1);
  targets.col(0) = 3.0 * features.col(0) - 2.0 * features.col(1);
  targets.array() += 7.0;
  GpConfig config;
  config.backend = GetParam();
  config.mean = MeanType::kLinear;
  const GpFit fit = fitGp(features, targets, config);
  Eigen::MatrixXd mean;
  const Eigen::MatrixXd far = (Eigen::MatrixXd(1, 2) << 100.0, -50.0).finished();
  GpPredictor(fit.model).predict(far, mean, nullptr);
  EXPECT_NEAR(mean(0, 0), 407.0, 1e-6);
}

TEST_P(Fit, AwkwardDataStillGivesFiniteAnswers) {
  struct Awkward {
    const char* name;
    Eigen::MatrixXd features;
    Eigen::MatrixXd targets;
  };
  std::vector<Awkward> cases;
  cases.push_back({"one point", normalMatrix(1, 3, 1), normalMatrix(1, 2, 2)});
  cases.push_back({"two points", normalMatrix(2, 3, 1), normalMatrix(2, 2, 2)});
  cases.push_back({"same point", normalMatrix(1, 3, 1).replicate(20, 1), normalMatrix(20, 2, 2)});
  cases.push_back(
      {"repeated points", normalMatrix(20, 3, 1).replicate(3, 1), normalMatrix(60, 2, 2)});
  cases.push_back(
      {"constant targets", normalMatrix(30, 3, 1), Eigen::MatrixXd::Constant(30, 2, 5.0)});
  cases.push_back({"zero targets", normalMatrix(30, 3, 1), Eigen::MatrixXd::Zero(30, 2)});
  Eigen::MatrixXd features = normalMatrix(50, 3, 3);
  const Eigen::MatrixXd targets = smoothTargets(features);
  features.col(1).setConstant(1e3);
  cases.push_back({"constant feature", features, targets});
  features.col(1).setZero();
  cases.push_back({"zero feature", features, targets});
  features = normalMatrix(50, 3, 3);
  features.col(0) *= 1e-12;
  features.col(2) *= 1e12;
  cases.push_back({"badly scaled", features, targets});
  features = normalMatrix(50, 3, 3);
  features.col(1) = features.col(0);
  cases.push_back({"same feature twice", features, targets});

  for (const Awkward& awkward : cases)
    for (const MeanType mean : {MeanType::kZero, MeanType::kConstant, MeanType::kLinear}) {
      GpConfig config;
      config.backend = GetParam();
      config.mean = mean;
      config.inducing_points = 30;
      config.groups = {{0, 1}};
      SCOPED_TRACE(awkward.name);
      const GpFit fit = fitGp(awkward.features, awkward.targets, config);
      Eigen::MatrixXd prediction;
      Eigen::MatrixXd variance;
      GpPredictor(fit.model).predict(awkward.features, prediction, &variance);
      EXPECT_TRUE(prediction.allFinite());
      EXPECT_TRUE(variance.allFinite());
      EXPECT_GE(variance.minCoeff(), 0.0);
      EXPECT_FALSE(fit.report.groups[0].message.empty());
    }
}

TEST_P(Fit, SameSeedSameModelBitForBit) {
  const Eigen::MatrixXd features = normalMatrix(150, 3, 6);
  GpConfig config;
  config.backend = GetParam();
  config.max_hyper_points = 80;
  config.inducing_points = 40;
  const GpFit a = fitGp(features, smoothTargets(features), config);
  const GpFit b = fitGp(features, smoothTargets(features), config);
  for (std::size_t g = 0; g < a.model.groups.size(); ++g) {
    EXPECT_EQ(a.model.groups[g].weights, b.model.groups[g].weights);
    EXPECT_EQ(a.model.groups[g].variance_factor, b.model.groups[g].variance_factor);
  }
}

INSTANTIATE_TEST_SUITE_P(Backends, Fit, ::testing::Values(GpBackend::kExact, GpBackend::kSparse));

void expectRefused(const Eigen::MatrixXd& features, const Eigen::MatrixXd& targets,
                   const GpConfig& config, const std::string& part) {
  try {
    fitGp(features, targets, config);
    FAIL() << "not refused; expected: " << part;
  } catch (const InvalidInput& error) {
    EXPECT_NE(std::string(error.what()).find(part), std::string::npos) << error.what();
  }
}

TEST(FitInput, RefusedWithRowAndColumn) {
  const Eigen::MatrixXd features = normalMatrix(10, 3, 1);
  const Eigen::MatrixXd targets = normalMatrix(10, 2, 2);
  Eigen::MatrixXd bad = features;
  bad(7, 2) = std::numeric_limits<double>::quiet_NaN();
  expectRefused(bad, targets, {}, "features row 7, column 2");
  bad = targets;
  bad(3, 1) = std::numeric_limits<double>::infinity();
  expectRefused(features, bad, {}, "targets row 3, column 1");
  expectRefused(features, normalMatrix(9, 2, 1), {}, "10 rows, targets 9");
  expectRefused(Eigen::MatrixXd(0, 3), Eigen::MatrixXd(0, 2), {}, "at least one row");
  GpConfig config;
  config.groups = {{0}, {0, 1}};
  expectRefused(features, targets, config, "output 0 is in 2 groups");
  config.groups = {{0}};
  expectRefused(features, targets, config, "output 1 is in 0 groups");
  config.groups = {{0, 5}};
  expectRefused(features, targets, config, "output 5");
  config.groups.clear();
  config.inducing_points = 0;
  expectRefused(features, targets, config, "inducing_points = 0");
}

}  // namespace
}  // namespace raven_correction
