// SPDX-License-Identifier: BSD-3-Clause
// Calibration of predicted intervals on groups of rows that were left out.
#include "raven_correction/regression/calibration.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "raven_correction/error.h"
#include "raven_correction/regression/gp_predictor.h"
#include "raven_correction/regression/inducing_points.h"
#include "raven_correction/regression/posterior.h"

namespace raven_correction {
namespace {

constexpr double kNormal95 = 1.959963984540054;  // 97.5 % quantile of the normal distribution

// Rows of each fold, groups dealt out in order of first appearance.
std::vector<std::vector<Eigen::Index>> foldRows(const std::vector<int>& groups, int folds) {
  std::map<int, int> fold_of;
  std::vector<std::vector<Eigen::Index>> rows(static_cast<std::size_t>(folds));
  for (std::size_t i = 0; i < groups.size(); ++i) {
    const int next = int(fold_of.size()) % folds;
    const int fold = fold_of.emplace(groups[i], next).first->second;
    rows[std::size_t(fold)].push_back(Eigen::Index(i));
  }
  return rows;
}

}  // namespace

std::vector<PredictionScore> scorePredictions(const Eigen::MatrixXd& truth,
                                              const Eigen::MatrixXd& mean,
                                              const Eigen::MatrixXd& variance) {
  if (truth.rows() == 0 || truth.rows() != mean.rows() || truth.cols() != mean.cols() ||
      truth.rows() != variance.rows() || truth.cols() != variance.cols())
    throw InvalidInput(format(
        "truth is %td x %td, means %td x %td, variances %td x %td; they must "
        "be of one size with at least one row",
        truth.rows(), truth.cols(), mean.rows(), mean.cols(), variance.rows(), variance.cols()));
  std::vector<PredictionScore> scores;
  for (Eigen::Index k = 0; k < truth.cols(); ++k) {
    const Eigen::ArrayXd squares = (truth.col(k) - mean.col(k)).array().square();
    const Eigen::ArrayXd v = variance.col(k).array();
    const double spread = (truth.col(k).array() - truth.col(k).mean()).square().mean();
    PredictionScore score;
    score.rmse = std::sqrt(squares.mean());
    score.smse = spread > 0.0 ? squares.mean() / spread : 0.0;
    score.nlpd = 0.5 * ((2.0 * M_PI * v).log() + squares / v).mean();
    score.coverage95 = (squares <= kNormal95 * kNormal95 * v).cast<double>().mean();
    scores.push_back(score);
  }
  return scores;
}

Eigen::MatrixXd observationVariance(const GpModel& model, const Eigen::MatrixXd& latent_variance) {
  Eigen::MatrixXd variance = latent_variance;
  for (const GpGroup& group : model.groups)
    for (std::size_t k = 0; k < group.outputs.size(); ++k)
      variance.col(group.outputs[k]).array() += group.noise_variance(Eigen::Index(k));
  return variance;
}

CalibrationResult calibrate(const GpModel& model, const Eigen::MatrixXd& features,
                            const Eigen::MatrixXd& targets, const std::vector<int>& groups,
                            int folds) {
  if (folds < 2) throw InvalidInput(format("folds = %d, must be 2 or more", folds));
  if (features.rows() != targets.rows() || features.rows() != Eigen::Index(groups.size()) ||
      features.cols() != model.features || targets.cols() != model.outputs)
    throw InvalidInput(
        format("%td x %td features, %td x %td targets and %zu group numbers do not "
               "fit together with a model of %d features and %d outputs",
               features.rows(), features.cols(), targets.rows(), targets.cols(), groups.size(),
               model.features, model.outputs));
  CalibrationResult result;
  result.variance_scale.setOnes(model.outputs);
  const std::vector<std::vector<Eigen::Index>> rows = foldRows(groups, folds);
  if (std::any_of(rows.begin(), rows.end(), [](const auto& fold) { return fold.empty(); }))
    return result;
  result.folds = folds;

  // Statistics of all rows once; each fold takes its rows away, predicts them, puts them back.
  const Eigen::MatrixXd points = features.transpose();
  std::vector<SparseStatistics> statistics;
  for (const GpGroup& group : model.groups) {
    statistics.emplace_back(group, group.points);
    statistics.back().update(points, groupTargets(group, targets), 1.0);
  }
  Eigen::MatrixXd mean(targets.rows(), targets.cols());
  Eigen::MatrixXd variance(targets.rows(), targets.cols());
  for (const std::vector<Eigen::Index>& fold : rows) {
    const Eigen::MatrixXd fold_points = selectColumns(points, fold);
    const Eigen::MatrixXd fold_targets = selectRows(targets, fold);
    GpModel without = model;
    for (std::size_t g = 0; g < statistics.size(); ++g) {
      const GpGroup& group = model.groups[g];
      SparseStatistics rest = statistics[g];
      rest.update(fold_points, groupTargets(group, fold_targets), -1.0);
      without.groups[g] = rest.posterior(group.variance_factor.rows());
    }
    Eigen::MatrixXd fold_mean;
    Eigen::MatrixXd fold_variance;
    GpPredictor(without).predict(fold_points.transpose(), fold_mean, &fold_variance);
    fold_variance = observationVariance(without, fold_variance);
    for (std::size_t i = 0; i < fold.size(); ++i) {
      mean.row(fold[i]) = fold_mean.row(Eigen::Index(i));
      variance.row(fold[i]) = fold_variance.row(Eigen::Index(i));
    }
  }
  result.before = scorePredictions(targets, mean, variance);
  for (Eigen::Index k = 0; k < targets.cols(); ++k) {
    std::vector<double> ratios;
    for (Eigen::Index i = 0; i < targets.rows(); ++i)
      if (variance(i, k) > 0.0)
        ratios.push_back(std::abs(targets(i, k) - mean(i, k)) / std::sqrt(variance(i, k)));
    if (ratios.empty()) continue;
    const auto middle = ratios.begin() + std::ptrdiff_t(0.95 * double(ratios.size() - 1) + 0.5);
    std::nth_element(ratios.begin(), middle, ratios.end());
    const double scale = *middle / kNormal95;
    if (scale > 0.0) result.variance_scale(k) = scale * scale;
  }
  result.after = scorePredictions(targets, mean, variance * result.variance_scale.asDiagonal());
  return result;
}

GpModel scaleVariance(const GpModel& model, const Eigen::VectorXd& variance_scale) {
  GpModel scaled = model;
  for (GpGroup& group : scaled.groups)
    for (std::size_t k = 0; k < group.outputs.size(); ++k) {
      const double factor = variance_scale(group.outputs[k]);
      group.signal_variance(Eigen::Index(k)) *= factor;
      group.noise_variance(Eigen::Index(k)) *= factor;
    }
  return scaled;
}

}  // namespace raven_correction
