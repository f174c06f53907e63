// SPDX-License-Identifier: BSD-3-Clause
// Rows added and dropped later give the model of training on the same rows at once.
#include "raven_correction/regression/online_process.h"

#include <gtest/gtest.h>

#include <limits>

#include "raven_correction/error.h"
#include "raven_correction/regression/gp_predictor.h"
#include "sample_problems.h"

namespace raven_correction {
namespace {

class Online : public ::testing::Test {
 protected:
  void SetUp() override {
    features_ = normalMatrix(600, 4, 1);
    targets_ = smoothTargets(features_) + 0.05 * normalMatrix(600, 2, 2);
    GpConfig config;
    config.inducing_points = 80;
    config.variance_points = 40;
    config.max_hyper_points = 200;
    config.groups = {{0, 1}};
    model_ = fitGp(features_.topRows(400), targets_.topRows(400), config).model;
  }

  double difference(const GpModel& a, const GpModel& b) const {
    const Eigen::MatrixXd queries = normalMatrix(100, 4, 3);
    Eigen::MatrixXd mean_a, mean_b, variance_a, variance_b;
    GpPredictor(a).predict(queries, mean_a, &variance_a);
    GpPredictor(b).predict(queries, mean_b, &variance_b);
    return std::max((mean_a - mean_b).cwiseAbs().maxCoeff(),
                    (variance_a - variance_b).cwiseAbs().maxCoeff());
  }

  Eigen::MatrixXd features_;
  Eigen::MatrixXd targets_;
  GpModel model_;
};

TEST_F(Online, StartsAsTheTrainedModel) {
  const OnlineProcess online(model_, features_.topRows(400), targets_.topRows(400));
  EXPECT_LT(difference(online.model(), model_), 1e-10);
}

TEST_F(Online, AddedAndDroppedRowsEqualTrainingOnTheSameSet) {
  OnlineProcess online(model_, features_.topRows(400), targets_.topRows(400));
  for (Eigen::Index first = 400; first < 600; first += 50)
    online.add(features_.middleRows(first, 50), targets_.middleRows(first, 50));
  online.dropOldest(150);
  EXPECT_EQ(online.rows(), 450);
  const OnlineProcess at_once(model_, features_.bottomRows(450), targets_.bottomRows(450));
  EXPECT_LT(difference(online.model(), at_once.model()), 1e-8);
  EXPECT_GT(difference(online.model(), model_), 1e-4);
}

TEST_F(Online, BadRowsAreRefusedAndChangeNothing) {
  OnlineProcess online(model_, features_.topRows(400), targets_.topRows(400));
  Eigen::MatrixXd bad = features_.topRows(5);
  bad(3, 1) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(online.add(bad, targets_.topRows(5)), InvalidInput);
  EXPECT_THROW(online.add(features_.topRows(5), targets_.topRows(4)), InvalidInput);
  EXPECT_THROW(online.dropOldest(401), InvalidInput);
  EXPECT_EQ(online.rows(), 400);
  EXPECT_LT(difference(online.model(), model_), 1e-10);
}

}  // namespace
}  // namespace raven_correction
