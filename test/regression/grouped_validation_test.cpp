// SPDX-License-Identifier: BSD-3-Clause
#include "raven_correction/regression/grouped_validation.h"

#include <gtest/gtest.h>

#include <random>

#include "raven_correction/error.h"
#include "raven_correction/regression/gaussian_process.h"
#include "raven_correction/regression/gp_predictor.h"

namespace raven_correction {
namespace {

/// Groups of neighbouring rows whose common error no feature explains: motions of a robot.
struct Motions {
  Eigen::MatrixXd points;   // d x n
  Eigen::MatrixXd targets;  // n x 2
  std::vector<int> groups;
};

double truth(double a, double b) { return std::sin(a) + 0.5 * std::cos(2.0 * b); }

Motions makeMotions(int count, int rows, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  Motions motions;
  motions.points.resize(3, count * rows);
  motions.targets.resize(count * rows, 2);
  for (int g = 0; g < count; ++g) {
    const Eigen::Vector3d start(1.5 * normal(random), 1.5 * normal(random), normal(random));
    const Eigen::Vector3d step(0.03 * normal(random), 0.03 * normal(random), 0.03);
    const double common = 0.3 * normal(random);
    for (int i = 0; i < rows; ++i) {
      const Eigen::Index n = g * rows + i;
      motions.points.col(n) = start + i * step;
      const double y = truth(motions.points(0, n), motions.points(1, n));
      motions.targets(n, 0) = y + common + 0.01 * normal(random);
      motions.targets(n, 1) = -y + common + 0.01 * normal(random);
      motions.groups.push_back(g);
    }
  }
  return motions;
}

TEST(GroupedValidation, GradientAgreesWithCentralDifferences) {
  const Motions motions = makeMotions(9, 12, 1);
  for (const KernelType kernel :
       {KernelType::kSquaredExponential, KernelType::kMatern32, KernelType::kMatern52})
    for (const std::vector<int>& blocks : {std::vector<int>{0, 1, 2}, std::vector<int>{0, 0, 1}}) {
      GroupedValidation::Options options;
      options.kernel = kernel;
      options.blocks = blocks;
      GroupedValidation validation(options, motions.points, motions.targets, motions.groups);
      std::mt19937_64 random(2);
      std::normal_distribution<double> normal;
      for (int trial = 0; trial < 3; ++trial) {
        Eigen::VectorXd x(validation.parameters());
        for (double& value : x) value = 0.5 + 0.4 * normal(random);
        x(x.size() - 1) = -2.0;
        Eigen::VectorXd gradient;
        validation.evaluate(x, &gradient);
        for (Eigen::Index k = 0; k < x.size(); ++k) {
          const double h = 1e-5;
          Eigen::VectorXd above = x, below = x;
          above(k) += h;
          below(k) -= h;
          const double difference =
              (validation.evaluate(above, nullptr) - validation.evaluate(below, nullptr)) /
              (2.0 * h);
          EXPECT_NEAR(gradient(k), difference, 1e-6 * gradient.norm()) << k;
        }
      }
    }
}

TEST(GroupedValidation, SeesTheCommonErrorOfAMotionThatTheLikelihoodTakesForSignal) {
  const Motions motions = makeMotions(40, 25, 3);
  const auto noiseOf = [&](HyperCriterion criterion) {
    GpConfig config;
    config.criterion = criterion;
    config.backend = GpBackend::kExact;
    config.groups = {{0, 1}};
    const GpFit fit = fitGp(motions.points.transpose(), motions.targets, config, motions.groups);
    return std::sqrt(fit.model.groups[0].noise_variance(0));
  };
  // Within a motion the rows scatter by 0.01 only, but motions differ by 0.3.
  EXPECT_LT(noiseOf(HyperCriterion::kLikelihood), 0.05);
  EXPECT_GT(noiseOf(HyperCriterion::kValidation), 0.05);
}

TEST(GroupedValidation, IntervalsHoldOnMotionsNotSeen) {
  const Motions motions = makeMotions(60, 20, 4), fresh = makeMotions(200, 5, 5);
  GpConfig config;
  config.criterion = HyperCriterion::kValidation;
  config.backend = GpBackend::kExact;
  config.groups = {{0, 1}};
  const GpFit fit = fitGp(motions.points.transpose(), motions.targets, config, motions.groups);
  Eigen::MatrixXd mean, variance;
  GpPredictor(fit.model).predict(fresh.points.transpose(), mean, &variance);
  int inside = 0;
  for (Eigen::Index i = 0; i < mean.rows(); ++i) {
    const double sd = std::sqrt(variance(i, 0) + fit.model.groups[0].noise_variance(0));
    inside += std::abs(fresh.targets(i, 0) - mean(i, 0)) < 1.96 * sd;
  }
  // 200 motions are 200 independent common errors: one deviation of the share is 1.5 %; the scale
  // itself comes from 60 motions, another 3 %. Four deviations of both.
  EXPECT_NEAR(inside / 1000.0, 0.95, 0.134);
  EXPECT_LT(inside, 1000);
}

TEST(GroupedValidation, NeedsTwoGroups) {
  const Motions motions = makeMotions(1, 12, 1);
  GroupedValidation::Options options;
  options.blocks = {0, 1, 2};
  EXPECT_THROW(GroupedValidation(options, motions.points, motions.targets, motions.groups),
               InvalidInput);
}

}  // namespace
}  // namespace raven_correction
