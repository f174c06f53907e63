// SPDX-License-Identifier: BSD-3-Clause
// Train on one table, test on another.
#include "raven_correction/regression/regress.h"

#include <algorithm>
#include <chrono>
#include <cmath>

#include "raven_correction/error.h"
#include "raven_correction/regression/gp_predictor.h"

namespace raven_correction {
namespace {

double secondsSince(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

}  // namespace

GpBackend backendFromName(const std::string& name) {
  if (name == "exact") return GpBackend::kExact;
  if (name == "sparse") return GpBackend::kSparse;
  throw InvalidInput(format("backend '%s' is unknown; use exact or sparse", name.c_str()));
}

const char* backendName(GpBackend backend) noexcept {
  return backend == GpBackend::kExact ? "exact" : "sparse";
}

GpConfig regressDefaults() {
  GpConfig config;
  config.kernel = KernelType::kSquaredExponential;
  config.backend = GpBackend::kExact;
  config.max_hyper_points = 3000;
  config.max_exact_points = 12000;
  return config;
}

RegressResult regress(const RegressProblem& problem) {
  const Eigen::Index q = problem.targets;
  const Eigen::Index d = problem.train.cols() - q;
  if (q < 1 || d < 1)
    throw InvalidInput(
        format("%td of %td columns are targets; at least one target and one feature "
               "are needed",
               q, problem.train.cols()));
  if (problem.test.cols() != problem.train.cols())
    throw InvalidInput(
        format("training table has %td columns, test table %td; they must be the "
               "same columns",
               problem.train.cols(), problem.test.cols()));
  if (problem.train.rows() == 0 || problem.test.rows() == 0)
    throw InvalidInput(format("%td training rows and %td test rows; at least one each is needed",
                              problem.train.rows(), problem.test.rows()));
  if (!problem.test.allFinite()) throw InvalidInput("test table: a value is not finite");

  const Eigen::RowVectorXd centre = problem.train.rightCols(q).colwise().mean();
  const GpFit fit = fitGp(problem.train.leftCols(d), problem.train.rightCols(q).rowwise() - centre,
                          problem.config);
  RegressResult result;
  result.report = fit.report;
  result.n_train = problem.train.rows();
  result.n_test = problem.test.rows();
  result.seconds_hyperparameters = fit.report.seconds_hyperparameters;
  for (const GpFitReport::Group& group : fit.report.groups)
    result.log_marginal_likelihood += group.log_marginal_likelihood;

  auto start = std::chrono::steady_clock::now();
  const GpPredictor predictor(fit.model);
  result.seconds_posterior = fit.report.seconds_posterior + secondsSince(start);
  start = std::chrono::steady_clock::now();
  Eigen::MatrixXd mean;
  predictor.predict(problem.test.leftCols(d), mean, nullptr);
  mean.rowwise() += centre;
  result.seconds_predict = secondsSince(start);

  start = std::chrono::steady_clock::now();
  const Eigen::Index rows =
      std::min<Eigen::Index>(std::max(1, problem.variance_rows), problem.test.rows());
  Eigen::MatrixXd first_mean;
  Eigen::MatrixXd variance;
  predictor.predict(problem.test.topLeftCorner(rows, d), first_mean, &variance);
  result.seconds_variance = secondsSince(start);
  result.n_variance = rows;

  const Eigen::MatrixXd truth = problem.test.rightCols(q);
  result.outputs = scorePredictions(truth.topRows(rows), mean.topRows(rows),
                                    observationVariance(fit.model, variance));
  for (Eigen::Index k = 0; k < q; ++k) {
    const double mse = (truth.col(k) - mean.col(k)).array().square().mean();
    const double spread = (truth.col(k).array() - truth.col(k).mean()).square().mean();
    result.outputs[std::size_t(k)].rmse = std::sqrt(mse);
    result.outputs[std::size_t(k)].smse = spread > 0.0 ? mse / spread : 0.0;
  }
  return result;
}

}  // namespace raven_correction
