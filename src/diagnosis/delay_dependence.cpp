// SPDX-License-Identifier: BSD-3-Clause
#include "delay_dependence.h"

#include <algorithm>
#include <cmath>

#include "raven_correction/geometry/statistics.h"

namespace raven_correction {
namespace {

constexpr int kRounds = 8;            // of weighting and fitting
constexpr double kThreshold = 1.345;  // where Huber's loss turns linear, in deviations [-]
constexpr double kSmallest = 1e-6;    // deviation, in the units of the residual [-]

struct DelayFit {
  Eigen::RowVectorXd residual, velocity;  // weighted means
  double delay = 0.0;
};

/// Weighted least squares in closed form.
DelayFit fitDelay(const Eigen::MatrixXd& residual, const Eigen::MatrixXd& velocity,
                  const Eigen::MatrixXd& weight) {
  const Eigen::RowVectorXd total = weight.colwise().sum().cwiseMax(1e-12);
  DelayFit fit;
  fit.residual = weight.cwiseProduct(residual).colwise().sum().cwiseQuotient(total);
  fit.velocity = weight.cwiseProduct(velocity).colwise().sum().cwiseQuotient(total);
  const Eigen::MatrixXd v = velocity.rowwise() - fit.velocity;
  const Eigen::MatrixXd r = residual.rowwise() - fit.residual;
  const double square = weight.cwiseProduct(v).cwiseProduct(v).sum();
  if (square > 0.0) fit.delay = -weight.cwiseProduct(v).cwiseProduct(r).sum() / square;
  return fit;
}

/// Huber's weights over the squared robust deviation of every component of what a fit leaves.
Eigen::MatrixXd weightsOf(const Eigen::MatrixXd& left) {
  Eigen::MatrixXd weight(left.rows(), left.cols());
  for (Eigen::Index k = 0; k < left.cols(); ++k) {
    std::vector<double> sizes;
    for (Eigen::Index i = 0; i < left.rows(); ++i) sizes.push_back(std::abs(left(i, k)));
    const double deviation = std::max(kSmallest, 1.4826 * median(std::move(sizes)));
    for (Eigen::Index i = 0; i < left.rows(); ++i)
      weight(i, k) =
          std::min(1.0, kThreshold * deviation / std::max(1e-300, std::abs(left(i, k)))) /
          (deviation * deviation);
  }
  return weight;
}

}  // namespace

DelayPrediction delayPredictions(const std::vector<ObservedSample>& samples,
                                 const Eigen::MatrixXd& residual, const Eigen::MatrixXd& velocity,
                                 int folds) {
  Eigen::MatrixXd weight = Eigen::MatrixXd::Ones(residual.rows(), residual.cols());
  DelayPrediction result;
  for (int round = 0; round < kRounds; ++round) {
    const DelayFit fit = fitDelay(residual, velocity, weight);
    result.delay = fit.delay;
    const Eigen::MatrixXd left =
        (residual.rowwise() - fit.residual) + fit.delay * (velocity.rowwise() - fit.velocity);
    weight = weightsOf(left);
  }
  result.predictions.resize(residual.rows(), residual.cols());
  for (int fold = 0; fold < folds; ++fold) {
    Eigen::MatrixXd others = weight;
    for (std::size_t s = 0; s < samples.size(); ++s)
      if (samples[s].motion % folds == fold) others.row(static_cast<Eigen::Index>(s)).setZero();
    const DelayFit fit = fitDelay(residual, velocity, others);
    for (std::size_t s = 0; s < samples.size(); ++s) {
      const auto row = static_cast<Eigen::Index>(s);
      if (samples[s].motion % folds == fold)
        result.predictions.row(row) = fit.residual - fit.delay * (velocity.row(row) - fit.velocity);
    }
  }
  return result;
}

}  // namespace raven_correction
