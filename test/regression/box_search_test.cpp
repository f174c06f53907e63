// SPDX-License-Identifier: BSD-3-Clause
// The searches of the hyper-parameters on criteria whose minimum is known.
#include "../../src/regression/box_search.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <cmath>
#include <limits>

namespace raven_correction {
namespace {

using Eigen::MatrixXd;
using Eigen::Vector2d;
using Eigen::VectorXd;

Box boxOf(const Vector2d& lower, const Vector2d& upper) { return {lower, upper}; }
const SearchLimits kLimits{200, 1e-14};

// 1/2 x'Ax - b'x
Objective quadratic(const Eigen::Matrix2d& A, const Vector2d& b) {
  return Objective([A, b](const VectorXd& x, VectorXd& gradient) {
    gradient = A * x - b;
    return 0.5 * x.dot(A * x) - b.dot(x);
  });
}

// Minima at (+-1, 0); between them it bends downwards.
Objective twoValleys() {
  return Objective([](const VectorXd& x, VectorXd& gradient) {
    gradient = Vector2d(4.0 * std::pow(x(0), 3) - 4.0 * x(0), 2.0 * x(1));
    return std::pow(x(0), 4) - 2.0 * x(0) * x(0) + x(1) * x(1);
  });
}

TEST(RefineInBox, KnownCurvatureTakesOneStep) {
  const Eigen::Matrix2d A = (Eigen::Matrix2d() << 3.0, 1.0, 1.0, 0.5).finished();
  Objective objective = quadratic(A, {1.0, 0.3});
  const SearchEnd end =
      refineInBox(objective, Vector2d(0.1, 0.1), A,
                  boxOf(Vector2d::Constant(-9.0), Vector2d::Constant(9.0)), kLimits);
  EXPECT_TRUE(end.converged) << end.message;
  EXPECT_EQ(end.iterations, 1);
  EXPECT_LT((objective.best - A.inverse() * Vector2d(1.0, 0.3)).norm(), 1e-12);
}

TEST(RefineInBox, FindsTheOptimumOnABoundFromAnother) {
  // Coupled: the unbounded step of the second parameter leaves the box when the first is held.
  const Eigen::Matrix2d A = (Eigen::Matrix2d() << 2.0, 1.8, 1.8, 2.0).finished();
  for (const double x0 : {0.0, 1.0})
    for (const double x1 : {0.0, 1.0}) {
      Objective objective = quadratic(A, {3.0, 0.5});
      const SearchEnd end = refineInBox(objective, Vector2d(x0, x1), Eigen::Matrix2d::Identity(),
                                        boxOf(Vector2d::Zero(), Vector2d::Ones()), kLimits);
      EXPECT_TRUE(end.converged) << end.message;
      EXPECT_LT((objective.best - Vector2d(1.0, 0.0)).norm(), 1e-7);
    }
}

TEST(RefineInBox, LeavesWhereItBendsDownwards) {
  Objective curvature = twoValleys();
  const Vector2d start(0.05, 0.7);
  const MatrixXd H = curvatureAt(curvature, start);
  EXPECT_GT(H.selfadjointView<Eigen::Lower>().eigenvalues().minCoeff(), 0.0);
  Objective objective = twoValleys();
  const SearchEnd end = refineInBox(
      objective, start, H, boxOf(Vector2d::Constant(-3.0), Vector2d::Constant(3.0)), kLimits);
  EXPECT_TRUE(end.converged) << end.message;
  EXPECT_NEAR(std::abs(objective.best(0)), 1.0, 1e-6);
  EXPECT_NEAR(objective.best(1), 0.0, 1e-6);
}

TEST(RefineInBox, AStartWithoutValueIsNotConverged) {
  Objective objective(
      [](const VectorXd&, VectorXd&) { return -std::numeric_limits<double>::infinity(); });
  const SearchEnd end = refineInBox(objective, Vector2d::Zero(), Eigen::Matrix2d::Identity(),
                                    boxOf(Vector2d::Zero(), Vector2d::Ones()), kLimits);
  EXPECT_FALSE(end.converged);
  EXPECT_EQ(end.iterations, 0);
}

TEST(RefineInBox, StopsAtTheLimitAndSaysSo) {
  Objective objective = twoValleys();
  const SearchEnd end =
      refineInBox(objective, Vector2d(2.5, 2.0), Eigen::Matrix2d::Identity(),
                  boxOf(Vector2d::Constant(-3.0), Vector2d::Constant(3.0)), {1, 1e-14});
  EXPECT_FALSE(end.converged);
  EXPECT_EQ(end.iterations, 1);
  EXPECT_NE(end.message.find("limit"), std::string::npos) << end.message;
}

TEST(SearchBox, FindsAValleyAndAnOptimumOnABound) {
  Objective objective = twoValleys();
  const SearchEnd end = searchBox(objective, Vector2d(0.3, 2.0),
                                  boxOf(Vector2d(-3.0, 0.5), Vector2d(0.8, 3.0)), kLimits);
  EXPECT_TRUE(end.converged) << end.message;
  EXPECT_LT((objective.best - Vector2d(0.8, 0.5)).norm(), 1e-6);
}

}  // namespace
}  // namespace raven_correction
