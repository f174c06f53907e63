// SPDX-License-Identifier: BSD-3-Clause
// A factor that grew and shrank answers as one made anew from the rows that are left.
#include "raven_correction/regression/exact_statistics.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "raven_correction/error.h"
#include "raven_correction/regression/gp_predictor.h"
#include "raven_correction/regression/inducing_points.h"
#include "raven_correction/regression/online_process.h"
#include "raven_correction/regression/posterior.h"
#include "sample_problems.h"

namespace raven_correction {
namespace {

/// Conditioned anew on those rows, in the order that the online model has.
GpGroup anew(const GpGroup& prior, const Eigen::MatrixXd& points, const Eigen::MatrixXd& targets,
             Eigen::Index variance_points) {
  GpGroup group = prior;
  const std::vector<Eigen::Index> order = varianceOrder(points);
  conditionExact(selectColumns(points, order), selectRows(targets, order), group, variance_points);
  return group;
}

void expectSame(const GpGroup& a, const GpGroup& b) {
  ASSERT_EQ(a.points, b.points);
  ASSERT_EQ(a.variance_factor.rows(), b.variance_factor.rows());
  const Eigen::MatrixXd queries = normalMatrix(80, a.points.rows(), 99);
  Eigen::MatrixXd mean_a, mean_b, variance_a, variance_b;
  GpPredictor(modelOf(a)).predict(queries, mean_a, &variance_a);
  GpPredictor(modelOf(b)).predict(queries, mean_b, &variance_b);
  // Rounding alone, which depends on the compiler: as ./run sanitize builds it, 1e-8 was too
  // little.
  EXPECT_LT((mean_a - mean_b).cwiseAbs().maxCoeff(), 5e-8);
  EXPECT_LT((variance_a - variance_b).cwiseAbs().maxCoeff(), 1e-8);
}

class ExactOnline : public ::testing::Test {
 protected:
  const Eigen::MatrixXd points_ = normalMatrix(4, 900, 1);
  const Eigen::MatrixXd targets_ =
      smoothTargets(points_.transpose()) + 0.05 * normalMatrix(900, 2, 2);
  GpGroup prior_ = [] {
    GpGroup group = plainGroup(KernelType::kMatern32, 4, 2, 0.01);
    group.mean_weights = normalMatrix(5, 2, 3);
    return group;
  }();
};

TEST_F(ExactOnline, RowsAddedInPartsEqualAllAtOnce) {
  // 300 rows leave room for 256 more: the parts pass that limit.
  ExactStatistics online(prior_, points_.leftCols(300), targets_.topRows(300));
  for (const auto& [first, count] : {std::pair{300, 100}, {400, 1}, {401, 299}, {700, 200}})
    online.append(points_.middleCols(first, count), targets_.middleRows(first, count));
  EXPECT_EQ(online.rows(), 900);
  expectSame(online.posterior(), anew(prior_, points_, targets_, 0));
  expectSame(online.posterior(70), anew(prior_, points_, targets_, 70));
}

TEST_F(ExactOnline, DroppedRowsLeaveNoTrace) {
  for (const Eigen::Index count : {1, 64, 250, 899}) {
    ExactStatistics online(prior_, points_, targets_);
    online.dropOldest(count);
    EXPECT_EQ(online.rows(), 900 - count);
    expectSame(online.posterior(50),
               anew(prior_, points_.rightCols(900 - count), targets_.bottomRows(900 - count), 50));
  }
}

TEST_F(ExactOnline, AWindowThatSlidesLongStaysExact) {
  ExactStatistics online(prior_, points_.leftCols(200), targets_.topRows(200));
  for (Eigen::Index first = 200; first < 900; first += 35) {
    online.append(points_.middleCols(first, 35), targets_.middleRows(first, 35));
    online.dropOldest(35);
  }
  expectSame(online.posterior(40),
             anew(prior_, points_.rightCols(200), targets_.bottomRows(200), 40));
}

TEST_F(ExactOnline, RepeatedRowsWithoutNoiseRaiseTheJitter) {
  prior_.noise_variance.setZero();
  ExactStatistics online(prior_, points_.leftCols(100), targets_.topRows(100));
  EXPECT_EQ(online.jitter(), 0.0);
  online.append(points_.leftCols(30), targets_.topRows(30));
  EXPECT_GT(online.jitter(), 0.0);
  EXPECT_EQ(online.rows(), 130);
  const GpGroup group = online.posterior();
  EXPECT_TRUE(group.weights.allFinite());
  EXPECT_TRUE(group.variance_factor.allFinite());
}

TEST_F(ExactOnline, BadInputIsRefusedAndChangesNothing) {
  ExactStatistics online(prior_, points_.leftCols(100), targets_.topRows(100));
  EXPECT_THROW(online.append(points_.leftCols(5), targets_.topRows(4)), InvalidInput);
  EXPECT_THROW(online.dropOldest(100), InvalidInput);
  EXPECT_THROW(online.dropOldest(-1), InvalidInput);
  expectSame(online.posterior(), anew(prior_, points_.leftCols(100), targets_.topRows(100), 0));
}

TEST_F(ExactOnline, ProcessEqualsTrainingOnTheSameRows) {
  GpConfig config;
  config.backend = GpBackend::kExact;
  config.exact_variance_points = 60;
  config.max_exact_points = 400;
  config.max_hyper_points = 200;
  config.groups = {{1, 0}};
  const GpFit fit = fitGp(points_.leftCols(800).transpose(), targets_.topRows(800), config);
  ASSERT_EQ(fit.posterior_rows.size(), 400u);
  OnlineProcess online(fit.model, selectRows(points_.transpose(), fit.posterior_rows),
                       selectRows(targets_, fit.posterior_rows), GpBackend::kExact);
  expectSame(online.model().groups[0], fit.model.groups[0]);
  online.add(points_.rightCols(100).transpose(), targets_.bottomRows(100));
  online.dropOldest(50);

  std::vector<Eigen::Index> rows(fit.posterior_rows.begin() + 50, fit.posterior_rows.end());
  for (Eigen::Index i = 800; i < 900; ++i) rows.push_back(i);
  EXPECT_EQ(online.rows(), 450);
  const GpGroup& trained = fit.model.groups[0];
  expectSame(online.model().groups[0], anew(trained, selectColumns(points_, rows),
                                            groupTargets(trained, selectRows(targets_, rows)), 60));
}

TEST(VarianceOrder, DoesNotDependOnTheOrderOfArrival) {
  const Eigen::MatrixXd points = normalMatrix(3, 200, 5);
  const Eigen::MatrixXd reversed = points.rowwise().reverse();
  EXPECT_EQ(selectColumns(points, varianceOrder(points)),
            selectColumns(reversed, varianceOrder(reversed)));
  // The first fifth stands for all: its mean place among 200 is 100 +- 58 / sqrt(40).
  const std::vector<Eigen::Index> order = varianceOrder(points);
  double sum = 0.0;
  for (int k = 0; k < 40; ++k) sum += double(order[std::size_t(k)]);
  EXPECT_NEAR(sum / 40.0, 99.5, 5.0 * 57.7 / std::sqrt(40.0));
}

}  // namespace
}  // namespace raven_correction
