// SPDX-License-Identifier: BSD-3-Clause
// Answers of one query, of many and from many threads are the same, and cost no allocation.
#include "raven_correction/regression/gp_predictor.h"

#include <gtest/gtest.h>

#include <limits>
#include <thread>
#include <vector>

#include "raven_correction/error.h"
#include "sample_problems.h"
#include "support/allocation_guard.h"

namespace raven_correction {
namespace {

GpModel sampleModel(GpBackend backend) {
  const Eigen::MatrixXd features = normalMatrix(150, 5, 1);
  GpConfig config;
  config.backend = backend;
  config.mean = MeanType::kLinear;
  config.inducing_points = 61;  // leaves a tail behind every vector width
  return fitGp(features, smoothTargets(features) + 0.05 * normalMatrix(150, 2, 2), config).model;
}

class Predictor : public ::testing::TestWithParam<GpBackend> {};

TEST_P(Predictor, OneQueryEqualsTheBatch) {
  const GpPredictor predictor(sampleModel(GetParam()));
  const Eigen::MatrixXd queries = normalMatrix(700, 5, 3);
  Eigen::MatrixXd mean;
  Eigen::MatrixXd variance;
  predictor.predict(queries, mean, &variance);
  const auto workspace = predictor.makeWorkspace();
  for (Eigen::Index i = 0; i < queries.rows(); ++i) {
    const Eigen::VectorXd x = queries.row(i);
    Eigen::Vector2d one_mean;
    Eigen::Vector2d one_variance;
    predictor.predict(x.data(), one_mean.data(), one_variance.data(), *workspace);
    for (Eigen::Index k = 0; k < 2; ++k) {
      ASSERT_NEAR(one_mean(k), mean(i, k), 1e-10);
      ASSERT_NEAR(one_variance(k), variance(i, k), 1e-10);
    }
  }
}

TEST_P(Predictor, SingleQueryDoesNotAllocate) {
  const GpPredictor predictor(sampleModel(GetParam()));
  const auto workspace = predictor.makeWorkspace();
  const Eigen::VectorXd x = normalMatrix(5, 1, 4);
  Eigen::Vector2d mean;
  Eigen::Vector2d variance;
  int allocations = 0;
  {
    const AllocationGuard guard;
    predictor.predict(x.data(), mean.data(), variance.data(), *workspace);
    predictor.predict(x.data(), mean.data(), nullptr, *workspace);
    allocations = guard.count();
  }
  EXPECT_EQ(allocations, 0);
#if RAVEN_COUNTS_ALLOCATIONS
  {
    const AllocationGuard guard;
    const std::vector<double> grown(1000, 1.0);
    EXPECT_EQ(grown.back(), 1.0);
    allocations = guard.count();
  }
  EXPECT_EQ(allocations, 1);  // the guard itself works
#endif
}

TEST_P(Predictor, ThreadsWithTheirOwnWorkspaceAgree) {
  const GpPredictor predictor(sampleModel(GetParam()));
  const Eigen::MatrixXd queries = normalMatrix(5, 400, 5);
  std::vector<Eigen::MatrixXd> means(3, Eigen::MatrixXd(2, queries.cols()));
  std::vector<std::thread> threads;
  for (Eigen::MatrixXd& mean : means)
    threads.emplace_back([&] {
      const auto workspace = predictor.makeWorkspace();
      for (Eigen::Index i = 0; i < queries.cols(); ++i)
        predictor.predict(queries.col(i).data(), mean.col(i).data(), nullptr, *workspace);
    });
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(means[0], means[1]);
  EXPECT_EQ(means[0], means[2]);
}

TEST_P(Predictor, FarFromAllDataItAnswersTheTrendAndThePrior) {
  const GpModel model = sampleModel(GetParam());
  const GpPredictor predictor(model);
  const Eigen::MatrixXd far = Eigen::MatrixXd::Constant(1, 5, 1e9);
  Eigen::MatrixXd mean;
  Eigen::MatrixXd variance;
  predictor.predict(far, mean, &variance);
  for (const GpGroup& group : model.groups) {
    const Eigen::Index k = group.outputs[0];
    const Eigen::MatrixXd trend = evaluateMean(group.mean_weights, far.transpose());
    EXPECT_NEAR(mean(0, k), trend(0, 0), 1e-9 * std::abs(trend(0, 0)) + 1e-12);
    EXPECT_DOUBLE_EQ(variance(0, k), group.signal_variance(0));
    EXPECT_DOUBLE_EQ(std::sqrt(variance(0, k)), predictor.priorDeviation()(k));
  }
}

TEST_P(Predictor, NonFiniteQueryGivesNonFiniteAnswerNotACrash) {
  const GpPredictor predictor(sampleModel(GetParam()));
  const auto workspace = predictor.makeWorkspace();
  Eigen::VectorXd x = Eigen::VectorXd::Zero(5);
  x(2) = std::numeric_limits<double>::quiet_NaN();
  Eigen::Vector2d mean;
  Eigen::Vector2d variance;
  predictor.predict(x.data(), mean.data(), variance.data(), *workspace);
  EXPECT_FALSE(mean.allFinite());
  EXPECT_FALSE(variance.allFinite());
}

INSTANTIATE_TEST_SUITE_P(Backends, Predictor,
                         ::testing::Values(GpBackend::kExact, GpBackend::kSparse));

TEST(PredictorInput, ModelsThatDoNotFitTogetherAreRefused) {
  const GpModel good = sampleModel(GpBackend::kSparse);
  const auto refused = [&](void (*damage)(GpModel&)) {
    GpModel model = good;
    damage(model);
    EXPECT_THROW(GpPredictor{model}, InvalidInput);
  };
  refused([](GpModel& m) { m.groups.clear(); });
  refused([](GpModel& m) { m.groups.pop_back(); });
  refused([](GpModel& m) { m.groups[1].outputs[0] = 0; });
  refused([](GpModel& m) { m.groups[0].outputs[0] = 2; });
  refused([](GpModel& m) { m.groups[0].weights.conservativeResize(3, 1); });
  refused([](GpModel& m) { m.groups[0].variance_factor.resize(0, 0); });
  refused([](GpModel& m) { m.groups[0].length_scales(0) = 0.0; });
  refused([](GpModel& m) { m.groups[0].weights(0, 0) = std::nan(""); });
  refused([](GpModel& m) { m.features = 4; });
}

}  // namespace
}  // namespace raven_correction
