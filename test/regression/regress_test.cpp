// SPDX-License-Identifier: BSD-3-Clause
// Two tables in, scores out; and what is not a table of the kind is refused.
#include "raven_correction/regression/regress.h"

#include <gtest/gtest.h>

#include <limits>

#include "raven_correction/error.h"
#include "sample_problems.h"

namespace raven_correction {
namespace {

Eigen::MatrixXd table(Eigen::Index rows, double noise, unsigned seed) {
  Eigen::MatrixXd result(rows, 5);
  result.leftCols(3) = normalMatrix(rows, 3, seed);
  result.rightCols(2) = smoothTargets(result.leftCols(3)) + noise * normalMatrix(rows, 2, seed + 1);
  result.rightCols(2).array() += 100.0;  // the mean is taken off
  return result;
}

RegressProblem problem() {
  RegressProblem problem;
  problem.train = table(500, 0.1, 1);
  problem.test = table(700, 0.1, 3);
  problem.targets = 2;
  problem.config = regressDefaults();
  problem.variance_rows = 400;
  return problem;
}

TEST(Regress, ScoresAreThoseOfTheNoise) {
  for (const GpBackend backend : {GpBackend::kExact, GpBackend::kSparse}) {
    RegressProblem asked = problem();
    asked.config.backend = backend;
    const RegressResult result = regress(asked);
    EXPECT_EQ(result.n_train, 500);
    EXPECT_EQ(result.n_test, 700);
    EXPECT_EQ(result.n_variance, 400);
    EXPECT_EQ(result.report.rows_learnt_on, 500);
    ASSERT_EQ(result.outputs.size(), 2u);
    for (const PredictionScore& score : result.outputs) {
      // Nothing predicts better than the noise; what 500 rows leave of the function is added.
      EXPECT_GT(score.rmse, 0.1 * (1.0 - 5.0 / std::sqrt(2.0 * 700.0)));
      EXPECT_LT(score.rmse, 0.4);
      EXPECT_NEAR(score.coverage95, 0.95, 0.05);
    }
    // A normal density of the noise alone has log(0.1 sqrt(2 pi e)) = -0.884 nat.
    EXPECT_GT(result.outputs[0].nlpd, -0.884 - 5.0 * std::sqrt(0.5 / 400.0));
    EXPECT_LT(result.outputs[0].nlpd, -0.3);
    EXPECT_LT(result.outputs[0].smse, 0.02);
  }
}

TEST(Regress, FewerRowsOfThePosteriorPredictWorse) {
  RegressProblem asked = problem();
  const double all = regress(asked).outputs[1].smse;
  asked.config.max_exact_points = 60;
  const RegressResult few = regress(asked);
  EXPECT_EQ(few.report.rows_used, 60);
  EXPECT_GT(few.outputs[1].smse, 2.0 * all);
}

TEST(Regress, TablesThatDoNotFitTogetherAreRefused) {
  const auto refused = [](void (*damage)(RegressProblem&), const std::string& part) {
    RegressProblem asked = problem();
    damage(asked);
    try {
      regress(asked);
      ADD_FAILURE() << "accepted: " << part;
    } catch (const InvalidInput& error) {
      EXPECT_NE(std::string(error.what()).find(part), std::string::npos) << error.what();
    }
  };
  refused([](RegressProblem& p) { p.targets = 5; }, "at least one target and one feature");
  refused([](RegressProblem& p) { p.targets = 0; }, "at least one target and one feature");
  refused([](RegressProblem& p) { p.test = p.test.leftCols(4).eval(); }, "same columns");
  refused([](RegressProblem& p) { p.train.resize(0, 5); }, "at least one each");
  refused([](RegressProblem& p) { p.test(3, 1) = std::numeric_limits<double>::infinity(); },
          "not finite");
  refused([](RegressProblem& p) { p.train(3, 1) = std::nan(""); }, "row 3, column 1");
}

TEST(Regress, NamesAreReadBack) {
  EXPECT_EQ(backendFromName(backendName(GpBackend::kExact)), GpBackend::kExact);
  EXPECT_EQ(backendFromName(backendName(GpBackend::kSparse)), GpBackend::kSparse);
  EXPECT_EQ(meanFromName("linear"), MeanType::kLinear);
  EXPECT_THROW(backendFromName("nystrom"), InvalidInput);
  EXPECT_THROW(meanFromName("quadratic"), InvalidInput);
}

}  // namespace
}  // namespace raven_correction
