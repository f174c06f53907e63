// SPDX-License-Identifier: BSD-3-Clause
// The model that the authors of the paper released, rebuilt from its hyper-parameters: the same
// weights, the same predictions, the published errors.
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <Eigen/SVD>

#include "raven_correction/regression/gp_predictor.h"
#include "raven_correction/regression/posterior.h"
#include "support/test_data.h"

namespace raven_correction {
namespace {

constexpr int kFeatures = 32;
constexpr int kOutputs = 12;

class Case2014Model : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = testData("case2014_left_model/README.md");
    RAVEN_SKIP_WITHOUT_DATA(folder_, "case2014_left_model");
    folder_.resize(folder_.size() - std::string("README.md").size());
    const Eigen::MatrixXd points = table("train_x_rigid_corrected").transpose();
    const Eigen::MatrixXd targets = table("train_y_recovered");
    // Rows: log length, log signal deviation, log noise deviation, 32 slopes, constant.
    const Eigen::MatrixXd hyper = table("hyp_logell_logsf_logsn_mean33");
    model_.features = kFeatures;
    model_.outputs = kOutputs;
    for (int k = 0; k < kOutputs; ++k) {
      GpGroup group;
      group.outputs = {k};
      group.kernel = KernelType::kMatern32;
      group.length_scales = Eigen::VectorXd::Constant(kFeatures, std::exp(hyper(k, 0)));
      group.signal_variance = Eigen::VectorXd::Constant(1, std::exp(2.0 * hyper(k, 1)));
      group.noise_variance = Eigen::VectorXd::Constant(1, std::exp(2.0 * hyper(k, 2)));
      group.mean_weights.resize(1 + kFeatures, 1);
      group.mean_weights(0, 0) = hyper(k, 35);
      group.mean_weights.bottomRows(kFeatures) = hyper.row(k).segment(3, kFeatures).transpose();
      EXPECT_EQ(conditionExact(points, targets.col(k), group), 0.0);
      model_.groups.push_back(group);
    }
  }

  Eigen::MatrixXd table(const std::string& name) const {
    return readTable(folder_ + name + ".csv");
  }

  // The stored test poses with the rigid step applied to their first 16 entries.
  Eigen::MatrixXd queries() const {
    Eigen::MatrixXd x = table("test_x_raw");
    const Eigen::Matrix4d T = table("rigid_T");
    for (Eigen::Index i = 0; i < x.rows(); ++i) {
      Eigen::Matrix4d pose;
      for (int r = 0; r < 4; ++r) pose.row(r) = x.row(i).segment(4 * r, 4);
      const Eigen::Matrix4d moved = T * pose;
      for (int r = 0; r < 4; ++r) x.row(i).segment(4 * r, 4) = moved.row(r);
    }
    return x;
  }

  std::string folder_;
  GpModel model_;
};

// Theirs multiply covariances, ours correlations: the signal variance is the difference.
Eigen::MatrixXd releasedWeights(const Eigen::MatrixXd& alpha, const GpModel& model) {
  Eigen::MatrixXd weights = alpha;
  for (int k = 0; k < kOutputs; ++k)
    weights.col(k) *= model.groups[std::size_t(k)].signal_variance(0);
  return weights;
}

TEST_F(Case2014Model, WeightsAreTheReleasedOnes) {
  const Eigen::MatrixXd released = releasedWeights(table("alpha"), model_);
  for (int k = 0; k < kOutputs; ++k) {
    // The files have 12 digits; a condition of up to n s^2 / sn^2 = 1e8 may multiply their error.
    EXPECT_LT((model_.groups[std::size_t(k)].weights - released.col(k)).cwiseAbs().maxCoeff(),
              1e-4 * released.col(k).cwiseAbs().maxCoeff());
  }
}

TEST_F(Case2014Model, PredictionsAreTheExpectedOnes) {
  const Eigen::MatrixXd expected = table("expected_predictions");
  GpModel stored = model_;
  const Eigen::MatrixXd released = releasedWeights(table("alpha"), model_);
  for (int k = 0; k < kOutputs; ++k) stored.groups[std::size_t(k)].weights = released.col(k);
  for (const GpModel* model : {&stored, &model_}) {
    Eigen::MatrixXd mean;
    GpPredictor(*model).predict(queries().topRows(expected.rows()), mean, nullptr);
    EXPECT_LT((mean - expected).cwiseAbs().maxCoeff(), 1e-8);
  }
}

TEST_F(Case2014Model, ErrorsOnTheTestPosesAreThePublishedOnes) {
  const Eigen::MatrixXd truth = table("test_y");
  Eigen::MatrixXd mean;
  GpPredictor(model_).predict(queries(), mean, nullptr);
  Eigen::Vector3d sum_error = Eigen::Vector3d::Zero();
  double sum_angle = 0.0;
  const auto rotation = [](const auto& row) {
    Eigen::Matrix3d R;
    R << row(0), row(1), row(2), row(4), row(5), row(6), row(8), row(9), row(10);
    return R;
  };
  for (Eigen::Index i = 0; i < truth.rows(); ++i) {
    const Eigen::JacobiSVD<Eigen::Matrix3d> svd(rotation(mean.row(i)),
                                                Eigen::ComputeFullU | Eigen::ComputeFullV);
    const Eigen::Matrix3d R = svd.matrixU() * svd.matrixV().transpose();
    const Eigen::Vector3d p(mean(i, 3), mean(i, 7), mean(i, 11));
    const Eigen::Vector3d p_true(truth(i, 3), truth(i, 7), truth(i, 11));
    sum_error += (R.transpose() * (p_true - p)).cwiseAbs();
    const double cosine = 0.5 * ((R.transpose() * rotation(truth.row(i))).trace() - 1.0);
    sum_angle += std::acos(std::max(-1.0, std::min(1.0, cosine)));
  }
  const double n = double(truth.rows());
  EXPECT_NEAR(1e3 * (sum_error / n).norm(), 2.13, 0.005);  // mm
  EXPECT_NEAR(sum_angle / n * 180.0 / M_PI, 2.35, 0.005);  // deg
}

}  // namespace
}  // namespace raven_correction
