// SPDX-License-Identifier: BSD-3-Clause
// Learning length scales, noise and mean from data: starts, bounds and search around
// marginal_likelihood.h. What to do with them is posterior.h.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <vector>

#include "raven_correction/regression/kernel.h"
#include "raven_correction/regression/mean_function.h"

namespace raven_correction {

/// What the hyper-parameters are chosen for.
enum class HyperCriterion {
  kLikelihood,  ///< largest log marginal likelihood (marginal_likelihood.h)
  kValidation,  ///< smallest error on groups of rows left out (grouped_validation.h)
};

struct HyperParameterProblem {
  KernelType kernel = KernelType::kMatern32;
  MeanType mean = MeanType::kZero;
  bool ard = true;          ///< one length scale per feature; false: one for all
  Eigen::MatrixXd points;   ///< d x n, any units
  Eigen::MatrixXd targets;  ///< n x q: outputs that share length scales and noise ratio
  HyperCriterion criterion = HyperCriterion::kLikelihood;
  std::vector<int> row_groups;  ///< n, kValidation: rows with equal numbers belong together
  /// d, kValidation with ard: features with equal numbers share a length scale (in units of their
  /// own standard deviations); empty: each has its own.
  std::vector<int> feature_blocks;
  int max_validation_rows = 700;  ///< kValidation: rows on either side of a fold
  int restarts = 1;               ///< searches; the first from the best of a grid, others random
  int max_iterations = 200;
  /// Standard deviation of a normal prior on each log length scale (in units of the feature's
  /// standard deviation) about the start; 0: none.
  double log_length_prior = 0.0;
  std::uint64_t seed = 1;
};

struct HyperParameterResult {
  Eigen::VectorXd length_scales;         ///< d, in units of the features
  Eigen::VectorXd signal_variance;       ///< q
  Eigen::VectorXd noise_variance;        ///< q
  Eigen::MatrixXd mean_weights;          ///< (1 + d) x q
  double log_marginal_likelihood = 0.0;  ///< of the targets in their own units [nat]
  bool converged = false;
  std::string message = "learnHyperParameters() has not run";
  double jitter = 0.0;  ///< added to the correlation matrix at the solution [-]
  int iterations = 0;   ///< of the best search
  int evaluations = 0;  ///< of all
};

/// Maximum of the log marginal likelihood, or minimum of the grouped validation error, on log
/// parameters. With kValidation the mean function is zero, and the signal variances
/// are those that make intervals honest on the rows left out.
///
/// Features are centred and divided by their standard deviation (one common scale unless ARD),
/// targets by their root mean square; a feature that is constant takes no part. Starts: the best,
/// on up to 256 rows, of four length scales around sqrt(d) and three noise ratios. The search goes
/// from coarse to fine: L-BFGS-B with restarts on every 4^k-th row; from the best of them, on four
/// times as many rows and so on, a quasi-Newton search that begins with the curvature of the fewer
/// rows, where features that these do not see start again from four times the shortest length
/// (`converged`, `iterations`: of the last search). Bounds: length
/// scales 1e-2 to 1e4 deviations, noise ratio 1e-8 to 1e3. (kValidation: one start, at most 40
/// iterations, log lengths -2 to 6, noise ratio 1e-5 to 10.) A search that stops early is data
/// (`converged`, `message`), and its best point is used.
/// @throws InvalidInput  kValidation with another mean than zero, or see GroupedValidation
HyperParameterResult learnHyperParameters(const HyperParameterProblem& problem);

}  // namespace raven_correction
