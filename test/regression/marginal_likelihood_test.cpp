// SPDX-License-Identifier: BSD-3-Clause
// The log marginal likelihood against its definition, its gradient against differences, and the
// hyper-parameters that it finds.
#include "raven_correction/regression/marginal_likelihood.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <tuple>

#include "raven_correction/regression/hyperparameters.h"
#include "raven_correction/regression/kernel.h"
#include "sample_problems.h"

namespace raven_correction {
namespace {

using Case = std::tuple<KernelType, MeanType, bool>;
class Likelihood : public ::testing::TestWithParam<Case> {};

// log N(y | H b, s^2 K) written out, for the s^2 and b that the code reports.
double logDensity(const Eigen::MatrixXd& K, const Eigen::MatrixXd& residual,
                  const Eigen::VectorXd& signal_variance) {
  const double n = double(K.rows());
  double value = 0.0;
  for (Eigen::Index k = 0; k < residual.cols(); ++k) {
    const Eigen::MatrixXd S = signal_variance(k) * K;
    value -= 0.5 * (n * std::log(2.0 * M_PI) + std::log(S.determinant()) +
                    residual.col(k).dot(S.inverse() * residual.col(k)));
  }
  return value;
}

TEST_P(Likelihood, EqualsItsDefinition) {
  const auto [kernel, mean, ard] = GetParam();
  const Eigen::MatrixXd points = normalMatrix(3, 20, 1);
  const Eigen::MatrixXd targets = smoothTargets(points.transpose());
  MarginalLikelihood likelihood(kernel, mean, ard, points, targets);
  Eigen::VectorXd parameters = Eigen::VectorXd::LinSpaced(likelihood.parameters(), 0.3, -1.0);
  const double value = likelihood.evaluate(parameters, nullptr);
  Eigen::MatrixXd K(20, 20);
  for (Eigen::Index i = 0; i < 20; ++i)
    for (Eigen::Index j = 0; j < 20; ++j) {
      Eigen::VectorXd difference = points.col(i) - points.col(j);
      for (Eigen::Index f = 0; f < 3; ++f) difference(f) /= std::exp(parameters(ard ? f : 0));
      K(i, j) = correlation(kernel, difference.norm());
    }
  K.diagonal().array() += std::exp(parameters(parameters.size() - 1));
  const Eigen::MatrixXd basis = meanBasis(mean, points);
  const Eigen::MatrixXd residual = targets - basis * likelihood.meanWeights();
  EXPECT_NEAR(value, logDensity(K, residual, likelihood.signalVariance()), 1e-9);
  // The reported signal variance and mean are the best ones: any other is less probable.
  Eigen::VectorXd other = likelihood.signalVariance() * 1.01;
  EXPECT_LT(logDensity(K, residual, other), value);
  if (basis.cols() > 0) {
    Eigen::MatrixXd shifted = residual;
    shifted.col(0).array() += 0.01;
    EXPECT_LT(logDensity(K, shifted, likelihood.signalVariance()), value);
  }
}

TEST_P(Likelihood, GradientAgreesWithCentralDifferences) {
  const auto [kernel, mean, ard] = GetParam();
  const Eigen::MatrixXd points = normalMatrix(4, 60, 2);
  const Eigen::MatrixXd targets = smoothTargets(points.transpose()) + 0.1 * normalMatrix(60, 2, 3);
  MarginalLikelihood likelihood(kernel, mean, ard, points, targets);
  const Eigen::VectorXd parameters = Eigen::VectorXd::LinSpaced(likelihood.parameters(), 0.8, -2.0);
  Eigen::VectorXd gradient;
  likelihood.evaluate(parameters, &gradient);
  ASSERT_EQ(gradient.size(), likelihood.parameters());
  for (Eigen::Index i = 0; i < gradient.size(); ++i) {
    // Fourth-order central difference: truncation h^4, rounding 1e-16 |value| / h.
    const double h = 1e-3;
    const auto at = [&](double step) {
      Eigen::VectorXd moved = parameters;
      moved(i) += step;
      return likelihood.evaluate(moved, nullptr);
    };
    const double difference = (8.0 * (at(h) - at(-h)) - (at(2.0 * h) - at(-2.0 * h))) / (12.0 * h);
    EXPECT_NEAR(gradient(i), difference, 1e-6 * std::max(1.0, std::abs(difference))) << i;
  }
}

INSTANTIATE_TEST_SUITE_P(
    All, Likelihood,
    ::testing::Combine(::testing::Values(KernelType::kSquaredExponential, KernelType::kMatern32,
                                         KernelType::kMatern52),
                       ::testing::Values(MeanType::kZero, MeanType::kConstant, MeanType::kLinear),
                       ::testing::Bool()));

TEST(HyperParameters, NoiseAndUselessFeatureAreFound) {
  HyperParameterProblem problem;
  problem.kernel = KernelType::kSquaredExponential;
  problem.points = normalMatrix(4, 300, 4);
  problem.points.row(1) *= 1e4;  // other units
  Eigen::MatrixXd features = problem.points.transpose();
  features.col(1) *= 1e-4;
  problem.targets = smoothTargets(features);
  const Eigen::VectorXd sigma = (Eigen::VectorXd(2) << 0.05, 0.5).finished();
  problem.targets += normalMatrix(300, 2, 5) * sigma.asDiagonal();
  // Only the first output, so that the noise ratio is its own.
  problem.targets = Eigen::MatrixXd(problem.targets.col(0));
  const HyperParameterResult result = learnHyperParameters(problem);
  EXPECT_TRUE(result.converged) << result.message;
  // 300 residuals know their deviation to 1/sqrt(600) = 4 %; five deviations.
  EXPECT_NEAR(std::sqrt(result.noise_variance(0)), 0.05, 5.0 * 0.05 / std::sqrt(600.0));
  EXPECT_GT(result.length_scales(3), 20.0 * result.length_scales(0));  // feature 3 does nothing
  EXPECT_GT(result.length_scales(1), 1e4);                             // units of the feature
}

class HyperParameterRows : public ::testing::TestWithParam<int> {};

// 1300 rows are searched from coarse to fine, 150 at once.
TEST_P(HyperParameterRows, SolutionIsStationary) {
  const int rows = GetParam();
  HyperParameterProblem problem;
  problem.points = normalMatrix(3, rows, 6);
  problem.targets = smoothTargets(problem.points.transpose()) + 0.1 * normalMatrix(rows, 2, 7);
  const HyperParameterResult result = learnHyperParameters(problem);
  MarginalLikelihood likelihood(problem.kernel, problem.mean, true, problem.points,
                                problem.targets);
  Eigen::VectorXd parameters(4);
  parameters.head(3) = result.length_scales.array().log();
  parameters(3) = std::log(result.noise_variance(0) / result.signal_variance(0));
  const double best = likelihood.evaluate(parameters, nullptr);
  // Sums over a factor whose condition grows as the noise ratio falls, in two units of the
  // features.
  const double rounding = rows * std::numeric_limits<double>::epsilon() / std::exp(parameters(3));
  EXPECT_NEAR(best, result.log_marginal_likelihood, rounding * std::abs(best));
  for (Eigen::Index i = 0; i < 4; ++i)
    for (const double step : {-0.05, 0.05}) {
      Eigen::VectorXd moved = parameters;
      moved(i) += step;
      EXPECT_LT(likelihood.evaluate(moved, nullptr), best + 0.01);
    }
}

INSTANTIATE_TEST_SUITE_P(Rows, HyperParameterRows, ::testing::Values(150, 1300));

// A quarter of the rows takes the weak bend of tanh for a line, which needs no length; all rows do
// not, and have to find their way back from a length at which the likelihood is flat.
TEST(HyperParameters, WhatFewRowsAreBlindToComesBackWithMore) {
  constexpr int kRows = 2000;
  HyperParameterProblem problem;
  problem.points = normalMatrix(8, kRows, 11);
  const Eigen::ArrayXXd x = problem.points.transpose().array();
  problem.targets = ((1.5 * x.col(0)).sin() + 0.5 * x.col(1) * x.col(2) + x.col(3).cos() +
                     0.3 * x.rightCols(4).rowwise().sum().tanh())
                        .matrix() +
                    0.1 * normalMatrix(kRows, 1, 12);
  const HyperParameterResult result = learnHyperParameters(problem);
  EXPECT_TRUE(result.converged) << result.message;
  const double shortest = result.length_scales.minCoeff();
  for (Eigen::Index j = 4; j < 8; ++j)
    EXPECT_LT(result.length_scales(j), 10.0 * shortest) << "feature " << j;
}

TEST(HyperParameters, UnitsOfFeaturesAndTargetsDoNotMatter) {
  HyperParameterProblem problem;
  problem.mean = MeanType::kLinear;
  problem.points = normalMatrix(3, 120, 8);
  problem.targets = smoothTargets(problem.points.transpose()) + 0.1 * normalMatrix(120, 2, 9);
  const HyperParameterResult plain = learnHyperParameters(problem);
  const Eigen::Vector3d unit(1e-6, 1.0, 1e6);
  problem.points = unit.asDiagonal() * problem.points;
  problem.points.colwise() += Eigen::Vector3d(1e-5, -3.0, 2e6);
  problem.targets *= 1e-3;
  const HyperParameterResult scaled = learnHyperParameters(problem);
  for (Eigen::Index j = 0; j < 3; ++j)
    EXPECT_NEAR(scaled.length_scales(j) / (unit(j) * plain.length_scales(j)), 1.0, 0.05);
  EXPECT_NEAR(scaled.log_marginal_likelihood, plain.log_marginal_likelihood + 240.0 * std::log(1e3),
              0.05);
}

TEST(HyperParameters, SameSeedSameResultBitForBit) {
  HyperParameterProblem problem;
  problem.points = normalMatrix(3, 80, 10);
  problem.targets = smoothTargets(problem.points.transpose());
  problem.restarts = 2;
  const HyperParameterResult first = learnHyperParameters(problem);
  const HyperParameterResult second = learnHyperParameters(problem);
  EXPECT_EQ(first.length_scales, second.length_scales);
  EXPECT_EQ(first.log_marginal_likelihood, second.log_marginal_likelihood);
}

}  // namespace
}  // namespace raven_correction
