// SPDX-License-Identifier: BSD-3-Clause
// Are the predicted intervals as wide as the errors on data that was left out? Checks them, and
// finds the factor that makes them so. The intervals themselves are gp_predictor.h.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "raven_correction/regression/gaussian_process.h"

namespace raven_correction {

/// Quality of predictions of one output. Intervals are of observations: latent variance plus noise.
struct PredictionScore {
  double rmse = 0.0;        ///< in units of the output
  double smse = 0.0;        ///< mean squared error over the variance of the true values [-]
  double nlpd = 0.0;        ///< mean negative log predictive density [nat]
  double coverage95 = 0.0;  ///< share of true values inside mean +- 1.96 deviations [-]
};

/// One score per output.
/// @param truth, mean  n x q;  variance: n x q, of observations, > 0
/// @throws InvalidInput  sizes differ or n = 0
std::vector<PredictionScore> scorePredictions(const Eigen::MatrixXd& truth,
                                              const Eigen::MatrixXd& mean,
                                              const Eigen::MatrixXd& variance);

/// Variance of observations: adds each output's noise to latent variances (n x q).
Eigen::MatrixXd observationVariance(const GpModel& model, const Eigen::MatrixXd& latent_variance);

struct CalibrationResult {
  Eigen::VectorXd variance_scale;       ///< q: factor on signal and noise variance; 1: none
  std::vector<PredictionScore> before;  ///< of the rows that were left out, one per output
  std::vector<PredictionScore> after;
  int folds = 0;  ///< that rows were left out in; 0: too few groups, nothing was checked
};

/// Leaves whole groups of rows (trajectories) out, fold by fold, with the hyper-parameters and
/// inducing points kept, and compares predictions with the truth. Rows of one group resemble each
/// other, so leaving out single rows would flatter the intervals.
///
///   variance_scale_k = ( 95 % quantile of |error_k| / deviation_k  /  1.96 )^2
///
/// Scaling signal and noise variance together widens every interval and moves no mean.
/// @param model     sparse; features n x d, targets n x q: the rows it was trained on
/// @param groups    n: which group each row belongs to
/// @param folds     2 or more; group g (in order of first appearance) is in fold g % folds
/// @throws InvalidInput  sizes do not fit together, or folds < 2
CalibrationResult calibrate(const GpModel& model, const Eigen::MatrixXd& features,
                            const Eigen::MatrixXd& targets, const std::vector<int>& groups,
                            int folds = 5);

/// The model with its signal and noise variances multiplied by variance_scale (q).
GpModel scaleVariance(const GpModel& model, const Eigen::VectorXd& variance_scale);

}  // namespace raven_correction
