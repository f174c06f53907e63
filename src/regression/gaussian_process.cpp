// SPDX-License-Identifier: BSD-3-Clause
// The fit: check the input, learn the hyper-parameters of each group, condition on the data.
#include "raven_correction/regression/gaussian_process.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <set>

#include "raven_correction/error.h"
#include "raven_correction/regression/exact_statistics.h"
#include "raven_correction/regression/fit_progress.h"
#include "raven_correction/regression/hyperparameters.h"
#include "raven_correction/regression/inducing_points.h"
#include "raven_correction/regression/kernel_matrix.h"
#include "raven_correction/regression/posterior.h"

namespace raven_correction {
namespace {

// Rows that the greedy choice of inducing points looks at, per inducing point.
constexpr Eigen::Index kCandidatesPerPoint = 10;
constexpr double kTypicalEvaluations = 20.0;  // of a search: half of the way
constexpr double kSearchShare = 0.9;          // of the time of a fit

double secondsSince(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

void checkFinite(const Eigen::MatrixXd& matrix, const char* name) {
  if (matrix.allFinite()) return;
  for (Eigen::Index i = 0; i < matrix.rows(); ++i)
    for (Eigen::Index j = 0; j < matrix.cols(); ++j)
      if (!std::isfinite(matrix(i, j)))
        throw InvalidInput(
            format("%s row %td, column %td (from 0) is %g; every value must be "
                   "finite, leave the row out",
                   name, i, j, matrix(i, j)));
}

std::vector<std::vector<int>> checkedGroups(const GpConfig& config, int outputs) {
  std::vector<std::vector<int>> groups = config.groups;
  if (groups.empty())
    for (int k = 0; k < outputs; ++k) groups.push_back({k});
  std::vector<int> uses(std::size_t(outputs), 0);
  for (const std::vector<int>& group : groups) {
    if (group.empty()) throw InvalidInput("a group of outputs is empty");
    for (const int k : group) {
      if (k < 0 || k >= outputs)
        throw InvalidInput(
            format("groups name output %d, but outputs are 0 to %d", k, outputs - 1));
      ++uses[std::size_t(k)];
    }
  }
  for (int k = 0; k < outputs; ++k)
    if (uses[std::size_t(k)] != 1)
      throw InvalidInput(
          format("output %d is in %d groups; it must be in exactly one", k, uses[std::size_t(k)]));
  return groups;
}

void checkConfig(const GpConfig& config) {
  const auto positive = [](const char* name, int value) {
    if (value <= 0) throw InvalidInput(format("%s = %d, must be > 0", name, value));
  };
  positive("max_hyper_points", config.max_hyper_points);
  positive("max_exact_points", config.max_exact_points);
  positive("inducing_points", config.inducing_points);
  positive("restarts", config.restarts);
  if (config.variance_points < 0)
    throw InvalidInput(format("variance_points = %d, must be >= 0", config.variance_points));
  if (!(config.log_length_prior >= 0.0))
    throw InvalidInput(format("log_length_prior = %g, must be >= 0", config.log_length_prior));
}

}  // namespace

GpFit fitGp(const Eigen::MatrixXd& features, const Eigen::MatrixXd& targets, const GpConfig& config,
            const std::vector<int>& row_groups) {
  return fitGp(features, targets, config, row_groups, {});
}

GpFit fitGp(const Eigen::MatrixXd& features, const Eigen::MatrixXd& targets, const GpConfig& config,
            const std::vector<int>& row_groups, const FitProgress& progress) {
  if (features.rows() == 0 || features.cols() == 0 || targets.cols() == 0)
    throw InvalidInput(
        format("features are %td x %td and targets have %td columns; at least one "
               "row, feature and target are needed",
               features.rows(), features.cols(), targets.cols()));
  if (features.rows() != targets.rows())
    throw InvalidInput(format("features have %td rows, targets %td; they must match row by row",
                              features.rows(), targets.rows()));
  checkFinite(features, "features");
  checkFinite(targets, "targets");
  checkConfig(config);
  if (!row_groups.empty() && Eigen::Index(row_groups.size()) != features.rows())
    throw InvalidInput(format("%zu row groups for %td rows; give one number per row, or none",
                              row_groups.size(), features.rows()));
  const bool validates = config.criterion == HyperCriterion::kValidation &&
                         std::set<int>(row_groups.begin(), row_groups.end()).size() >= 3;

  const Eigen::MatrixXd points = features.transpose();
  const Eigen::Index n = points.cols();
  GpFit fit;
  fit.model.features = int(points.rows());
  fit.model.outputs = int(targets.cols());
  fit.report.rows = int(n);

  fit.posterior_rows = sampleIndices(
      n, config.backend == GpBackend::kExact ? config.max_exact_points : n, config.seed);
  fit.report.rows_used = int(fit.posterior_rows.size());
  const std::vector<Eigen::Index> hyper_rows =
      sampleIndices(n, config.max_hyper_points, config.seed);
  fit.report.rows_learnt_on = validates ? int(n) : int(hyper_rows.size());
  const std::vector<std::vector<int>> groups = checkedGroups(config, fit.model.outputs);
  const auto report_group = [&](double of_group) {
    if (!progress) return;
    progress((static_cast<double>(fit.model.groups.size()) + of_group) /
             static_cast<double>(groups.size()));
  };
  for (const std::vector<int>& outputs : groups) {
    Eigen::MatrixXd group_targets(n, Eigen::Index(outputs.size()));
    for (std::size_t k = 0; k < outputs.size(); ++k)
      group_targets.col(Eigen::Index(k)) = targets.col(outputs[k]);

    auto start = std::chrono::steady_clock::now();
    HyperParameterProblem problem;
    problem.kernel = config.kernel;
    problem.mean = config.mean;
    problem.ard = config.ard;
    problem.points = validates ? points : selectColumns(points, hyper_rows);
    problem.targets = validates ? group_targets : selectRows(group_targets, hyper_rows);
    if (validates) {
      problem.criterion = HyperCriterion::kValidation;
      problem.row_groups = row_groups;
      problem.feature_blocks = config.feature_blocks;
      problem.max_validation_rows = config.max_hyper_points;
    }
    problem.restarts = config.restarts;
    problem.log_length_prior = config.log_length_prior;
    problem.seed = config.seed;
    double evaluations = 0.0;
    const HyperParameterResult learnt = learnHyperParameters(problem, [&] {
      evaluations += 1.0;
      report_group(kSearchShare * evaluations / (evaluations + kTypicalEvaluations));
    });
    fit.report.seconds_hyperparameters += secondsSince(start);

    start = std::chrono::steady_clock::now();
    GpGroup group;
    group.outputs = outputs;
    group.kernel = config.kernel;
    group.length_scales = learnt.length_scales;
    group.signal_variance = learnt.signal_variance;
    group.noise_variance = learnt.noise_variance;
    group.mean_weights = learnt.mean_weights;
    double jitter = 0.0;
    if (config.backend == GpBackend::kExact) {
      const Eigen::MatrixXd chosen = selectColumns(points, fit.posterior_rows);
      const std::vector<Eigen::Index> order = varianceOrder(chosen);
      jitter = conditionExact(selectColumns(chosen, order),
                              selectRows(selectRows(group_targets, fit.posterior_rows), order),
                              group, config.exact_variance_points);
    } else {
      const std::vector<Eigen::Index> inducing = chooseInducingPoints(
          config.kernel, scalePoints(points, group.length_scales), config.inducing_points,
          kCandidatesPerPoint * Eigen::Index(config.inducing_points), config.seed);
      SparseStatistics statistics(group, selectColumns(points, inducing));
      statistics.update(points, group_targets, 1.0);
      // Noise that was validated on motions left out is not for the likelihood to change.
      if (config.noise_from_all_rows && !validates) statistics.learnNoise();
      group = statistics.posterior(config.variance_points);
      jitter = statistics.jitter();
    }
    fit.report.seconds_posterior += secondsSince(start);
    fit.model.groups.push_back(std::move(group));
    report_group(0.0);

    GpFitReport::Group report;
    report.log_marginal_likelihood = learnt.log_marginal_likelihood;
    report.converged = learnt.converged;
    report.message = learnt.message;
    report.jitter = std::max(jitter, learnt.jitter);
    report.iterations = learnt.iterations;
    fit.report.groups.push_back(report);
  }
  return fit;
}

}  // namespace raven_correction
