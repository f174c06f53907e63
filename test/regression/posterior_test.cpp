// SPDX-License-Identifier: BSD-3-Clause
// Exact and sparse posteriors against the textbook formula and against each other.
#include "raven_correction/regression/posterior.h"

#include <gtest/gtest.h>

#include <Eigen/LU>

#include "raven_correction/error.h"
#include "raven_correction/regression/gp_predictor.h"
#include "raven_correction/regression/inducing_points.h"
#include "raven_correction/regression/kernel_matrix.h"
#include "sample_problems.h"

namespace raven_correction {
namespace {

struct Prediction {
  Eigen::MatrixXd mean;
  Eigen::MatrixXd variance;
};

Prediction predictAt(const GpGroup& group, const Eigen::MatrixXd& queries) {
  Prediction result;
  GpPredictor(modelOf(group)).predict(queries, result.mean, &result.variance);
  return result;
}

TEST(ExactPosterior, EqualsTheTextbookFormula) {
  const Eigen::MatrixXd points = normalMatrix(3, 40, 1);
  const Eigen::MatrixXd targets = smoothTargets(points.transpose());
  const Eigen::MatrixXd queries = normalMatrix(25, 3, 2);
  GpGroup group = plainGroup(KernelType::kMatern52, 3, 2, 0.01);
  group.mean_weights = normalMatrix(4, 2, 3);
  EXPECT_EQ(conditionExact(points, targets, group), 0.0);
  const Prediction prediction = predictAt(group, queries);

  const Eigen::MatrixXd a = scalePoints(points, group.length_scales);
  const Eigen::MatrixXd b = scalePoints(queries.transpose(), group.length_scales);
  Eigen::MatrixXd K;
  Eigen::MatrixXd c;
  kernelMatrix(group.kernel, a, a, K);
  kernelMatrix(group.kernel, a, b, c);
  K.diagonal().array() += 0.01;
  const Eigen::MatrixXd inverse = K.inverse();
  const Eigen::MatrixXd trend = evaluateMean(group.mean_weights, points);
  const Eigen::MatrixXd mean = evaluateMean(group.mean_weights, queries.transpose()) +
                               c.transpose() * inverse * (targets - trend);
  EXPECT_LT((prediction.mean - mean).cwiseAbs().maxCoeff(), 1e-10);
  for (Eigen::Index i = 0; i < 25; ++i)
    for (Eigen::Index k = 0; k < 2; ++k)
      EXPECT_NEAR(prediction.variance(i, k),
                  group.signal_variance(k) * (1.0 - c.col(i).dot(inverse * c.col(i))), 1e-10);
}

TEST(SparsePosterior, EqualsTheExactOneWhenTheInducingPointsAreTheData) {
  for (const KernelType kernel :
       {KernelType::kSquaredExponential, KernelType::kMatern32, KernelType::kMatern52}) {
    const Eigen::MatrixXd points = 3.0 * normalMatrix(3, 60, 4);
    const Eigen::MatrixXd targets = smoothTargets(points.transpose());
    const Eigen::MatrixXd queries = 3.0 * normalMatrix(50, 3, 5);
    GpGroup exact = plainGroup(kernel, 3, 2, 0.02);
    exact.mean_weights = normalMatrix(4, 2, 6);
    SparseStatistics statistics(exact, points);
    statistics.update(points, targets, 1.0);
    conditionExact(points, targets, exact);
    const Prediction a = predictAt(exact, queries);
    const Prediction b = predictAt(statistics.posterior(), queries);
    EXPECT_LT((a.mean - b.mean).cwiseAbs().maxCoeff(), 1e-8) << kernelName(kernel);
    EXPECT_LT((a.variance - b.variance).cwiseAbs().maxCoeff(), 1e-8) << kernelName(kernel);
  }
}

TEST(SparsePosterior, NoDataGivesThePrior) {
  const GpGroup prior = plainGroup(KernelType::kMatern32, 3, 2, 0.02);
  const SparseStatistics statistics(prior, normalMatrix(3, 20, 7));
  const Prediction prediction = predictAt(statistics.posterior(), normalMatrix(10, 3, 8));
  EXPECT_LT(prediction.mean.cwiseAbs().maxCoeff(), 1e-14);
  for (Eigen::Index k = 0; k < 2; ++k)
    EXPECT_LT((prediction.variance.col(k).array() - prior.signal_variance(k)).abs().maxCoeff(),
              1e-12 * prior.signal_variance(k));
}

TEST(SparsePosterior, ComesCloserToTheExactOneWithMoreInducingPoints) {
  const Eigen::MatrixXd points = normalMatrix(2, 300, 9);
  const Eigen::MatrixXd targets = smoothTargets(normalMatrix(300, 3, 10));
  const Eigen::MatrixXd queries = normalMatrix(100, 2, 11);
  const GpGroup prior = plainGroup(KernelType::kMatern32, 2, 2, 0.05);
  GpGroup exact = prior;
  conditionExact(points, targets, exact);
  const Prediction a = predictAt(exact, queries);
  double last = 1e9;
  for (const Eigen::Index count : {10, 40, 160}) {
    const std::vector<Eigen::Index> chosen =
        chooseInducingPoints(prior.kernel, scalePoints(points, prior.length_scales), count, 300, 1);
    SparseStatistics statistics(prior, selectColumns(points, chosen));
    statistics.update(points, targets, 1.0);
    const Prediction b = predictAt(statistics.posterior(), queries);
    const double distance = (a.mean - b.mean).norm() + (a.variance - b.variance).norm();
    EXPECT_LT(distance, 0.7 * last) << count;
    last = distance;
  }
}

TEST(SparsePosterior, RowsMayComeInPartsAndLeaveAgain) {
  const Eigen::MatrixXd points = normalMatrix(3, 500, 12);
  const Eigen::MatrixXd targets = smoothTargets(points.transpose());
  const GpGroup prior = plainGroup(KernelType::kMatern32, 3, 2, 0.01);
  SparseStatistics once(prior, points.leftCols(50));
  once.update(points.leftCols(400), targets.topRows(400), 1.0);
  SparseStatistics parts(prior, points.leftCols(50));
  parts.update(points, targets, 1.0);
  parts.update(points.rightCols(100), targets.bottomRows(100), -1.0);
  EXPECT_EQ(parts.rows(), 400.0);
  const Eigen::MatrixXd queries = normalMatrix(40, 3, 13);
  const Prediction a = predictAt(once.posterior(), queries);
  const Prediction b = predictAt(parts.posterior(), queries);
  EXPECT_LT((a.mean - b.mean).cwiseAbs().maxCoeff(), 1e-8);
  EXPECT_LT((a.variance - b.variance).cwiseAbs().maxCoeff(), 1e-8);
  parts.update(points, targets, -1.0);
  EXPECT_THROW(parts.posterior(), InvalidInput);
}

TEST(SparsePosterior, VarianceOfTheFirstPointsIsThatOfASmallerModel) {
  const Eigen::MatrixXd points = normalMatrix(3, 300, 17);
  const Eigen::MatrixXd targets = smoothTargets(points.transpose());
  const GpGroup prior = plainGroup(KernelType::kMatern32, 3, 2, 0.01);
  SparseStatistics large(prior, points.leftCols(90));
  large.update(points, targets, 1.0);
  SparseStatistics small(prior, points.leftCols(35));
  small.update(points, targets, 1.0);
  const Eigen::MatrixXd queries = normalMatrix(50, 3, 18);
  const Prediction all = predictAt(large.posterior(), queries);
  const Prediction nested = predictAt(large.posterior(35), queries);
  const Prediction alone = predictAt(small.posterior(), queries);
  EXPECT_LT((nested.mean - all.mean).cwiseAbs().maxCoeff(), 1e-12);
  EXPECT_LT((nested.variance - alone.variance).cwiseAbs().maxCoeff(), 1e-10);
  EXPECT_GT((nested.variance - all.variance).maxCoeff(), 1e-3);
}

TEST(SparsePosterior, NoiseOfAllRowsIsFoundAndIsTheMostProbable) {
  const Eigen::MatrixXd points = normalMatrix(2, 2000, 19);
  Eigen::MatrixXd targets(2000, 1);
  targets.col(0) = points.row(0).array().sin().transpose();
  targets += 0.1 * normalMatrix(2000, 1, 20);
  GpGroup prior = plainGroup(KernelType::kSquaredExponential, 2, 1, 1e-8);
  SparseStatistics statistics(prior, points.leftCols(60));
  statistics.update(points, targets, 1.0);
  statistics.learnNoise();
  // 2000 residuals know their deviation to 1/sqrt(4000); five deviations.
  EXPECT_NEAR(std::sqrt(statistics.group().noise_variance(0)), 0.1, 5.0 * 0.1 / std::sqrt(4000.0));
}

TEST(Posterior, RepeatedPointsWithoutNoiseTakeJitterAndSayHowMuch) {
  Eigen::MatrixXd points = normalMatrix(2, 30, 14);
  points.rightCols(15) = points.leftCols(15);
  const Eigen::MatrixXd targets = normalMatrix(30, 1, 15);
  GpGroup group = plainGroup(KernelType::kSquaredExponential, 2, 1, 0.0);
  EXPECT_GT(conditionExact(points, targets, group), 0.0);
  EXPECT_TRUE(group.weights.allFinite());
}

TEST(InducingPoints, ChosenPointsCoverBetterThanRandomOnesAndNeverRepeat) {
  Eigen::MatrixXd points = normalMatrix(3, 400, 16);
  points.rightCols(200) = points.leftCols(200);
  const std::vector<Eigen::Index> chosen =
      chooseInducingPoints(KernelType::kMatern32, points, 300, 10000, 1);
  EXPECT_EQ(chosen.size(), 200u);  // 200 different points are all there is
  const auto worst = [&](const std::vector<Eigen::Index>& rows) {
    const GpGroup prior = plainGroup(KernelType::kMatern32, 3, 1, 1e-6);
    GpGroup group = prior;
    group.length_scales.setOnes();
    conditionExact(selectColumns(points, rows), Eigen::MatrixXd::Zero(Eigen::Index(rows.size()), 1),
                   group);
    return predictAt(group, points.transpose()).variance.maxCoeff();
  };
  const std::vector<Eigen::Index> greedy =
      chooseInducingPoints(KernelType::kMatern32, points, 40, 10000, 1);
  EXPECT_EQ(greedy.size(), 40u);
  EXPECT_LT(worst(greedy), 0.8 * worst(sampleIndices(200, 40, 1)));
}

}  // namespace
}  // namespace raven_correction
