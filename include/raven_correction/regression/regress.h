// SPDX-License-Identifier: BSD-3-Clause
// The engine alone on two tables: learn from one, predict the other, and say how well and how
// fast. Reading the tables is dataset/csv.h; the command line is the offline program.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "raven_correction/regression/calibration.h"
#include "raven_correction/regression/gaussian_process.h"

namespace raven_correction {

struct RegressProblem {
  Eigen::MatrixXd train;  ///< rows of d features and, in the last columns, the targets
  Eigen::MatrixXd test;   ///< the same columns
  int targets = 1;        ///< how many of the last columns are targets
  GpConfig config;
  int variance_rows = 2000;  ///< first test rows whose variance, density and coverage are scored
};

struct RegressResult {
  /// smse and rmse over all test rows, nlpd and coverage95 over the first `variance_rows`.
  std::vector<PredictionScore> outputs;
  double log_marginal_likelihood = 0.0;  ///< sum over groups, on the rows it was maximised on
  double seconds_hyperparameters = 0.0;
  double seconds_posterior = 0.0;
  double seconds_predict = 0.0;   ///< means of all test rows
  double seconds_variance = 0.0;  ///< variances of the first rows
  Eigen::Index n_train = 0;
  Eigen::Index n_test = 0;
  Eigen::Index n_variance = 0;  ///< test rows whose nlpd and coverage95 were scored
  GpFitReport report;
};

/// What `offline regress` does unless it is told otherwise: the exact posterior on all rows (12,000
/// at most), hyper-parameters by marginal likelihood.
GpConfig regressDefaults();

/// The mean of each target is taken off before and put back after the fit.
/// @throws InvalidInput  tables of different width, no feature left, or see fitGp()
RegressResult regress(const RegressProblem& problem);

/// "exact" or "sparse". @throws InvalidInput  for any other name
GpBackend backendFromName(const std::string& name);
const char* backendName(GpBackend backend) noexcept;

}  // namespace raven_correction
