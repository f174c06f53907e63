// SPDX-License-Identifier: BSD-3-Clause
// Gaussian process regression of q outputs on d features: what is asked for (GpConfig), what was
// learnt (GpModel, plain data that a file can hold), and the fit between them. Answering queries
// fast is gp_predictor.h.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <vector>

#include "raven_correction/regression/hyperparameters.h"
#include "raven_correction/regression/kernel.h"
#include "raven_correction/regression/mean_function.h"

namespace raven_correction {

enum class GpBackend { kExact, kSparse };

struct GpConfig {
  KernelType kernel = KernelType::kMatern32;
  bool ard = true;                  ///< one length scale per feature; false: one for all
  std::vector<int> feature_blocks;  ///< see HyperParameterProblem
  HyperCriterion criterion = HyperCriterion::kLikelihood;
  MeanType mean = MeanType::kZero;
  GpBackend backend = GpBackend::kSparse;
  /// Outputs that share a kernel: length scales and the ratio of noise to signal variance are
  /// common, the signal variance is each output's own. Every output in exactly one group; empty:
  /// each output is its own group.
  std::vector<std::vector<int>> groups;
  int max_hyper_points = 1000;  ///< rows that the hyper-parameters are learnt on, chosen by seed
  int max_exact_points = 4000;  ///< kExact: rows of the posterior, chosen by seed
  /// kExact: how many of them the variance uses, chosen by exact_statistics.h; 0: all.
  int exact_variance_points = 0;
  int inducing_points = 1000;       ///< kSparse: size of the inducing set of each group
  int variance_points = 500;        ///< kSparse: how many of them the variance uses; 0: all
  bool noise_from_all_rows = true;  ///< kSparse: see SparseStatistics::learnNoise()
  int restarts = 1;                 ///< starts of the hyper-parameter search
  double log_length_prior = 0.0;    ///< see HyperParameterProblem; 0: no prior
  std::uint64_t seed = 1;
};

/// One group of outputs after learning.
///   mean_k(x)     = [1 x'] B_k + sum_i c(x, z_i) alpha(i, k)
///   variance_k(x) = s_k^2 (1 - || T c ||^2), c_i = c(x, z_i); of the latent function
/// Exact: z are the training rows and T is the inverse Cholesky factor of their correlation plus
/// noise ratio. T may use the first points only (mv <= m): the mean costs m per query, the variance
/// mv^2. Sparse: z are inducing points (posterior.h). Observations add noise_variance(k).
struct GpGroup {
  std::vector<int> outputs;  ///< indices into the q outputs
  KernelType kernel = KernelType::kMatern32;
  Eigen::VectorXd length_scales;    ///< d, in units of the features
  Eigen::VectorXd signal_variance;  ///< one per output of the group
  Eigen::VectorXd noise_variance;   ///< one per output of the group
  Eigen::MatrixXd points;           ///< d x m: z, training rows or inducing points
  Eigen::MatrixXd weights;          ///< m x outputs: alpha
  Eigen::MatrixXd mean_weights;     ///< (1 + d) x outputs: B; zero where the mean is zero
  Eigen::MatrixXd variance_factor;  ///< mv x mv lower triangular: T of the first mv points
};

struct GpModel {
  int features = 0;  ///< d
  int outputs = 0;   ///< q
  std::vector<GpGroup> groups;
};

struct GpFitReport {
  struct Group {
    double log_marginal_likelihood = 0.0;  ///< on the rows the hyper-parameters were learnt on
    bool converged = false;
    std::string message;  ///< why the search ended
    double jitter = 0.0;  ///< added to the diagonal, relative to the signal variance [-]
    int iterations = 0;
  };
  std::vector<Group> groups;
  int rows = 0;            ///< given
  int rows_learnt_on = 0;  ///< the hyper-parameters
  int rows_used = 0;       ///< in the posterior
  double seconds_hyperparameters = 0.0;
  double seconds_posterior = 0.0;
};

struct GpFit {
  GpModel model;
  GpFitReport report;
  std::vector<Eigen::Index> posterior_rows;  ///< that the posterior is conditioned on, in order
};

/// Learns hyper-parameters by maximum log marginal likelihood, then the posterior.
/// @param features  n x d, any units
/// @param targets   n x q
/// @param row_groups  n numbers, or empty: rows with equal numbers belong together (one motion);
///        needed for HyperCriterion::kValidation, which falls back to the likelihood below 3 groups
/// @throws InvalidInput  n = 0, sizes differ, or a value is not finite (the text has row, column)
GpFit fitGp(const Eigen::MatrixXd& features, const Eigen::MatrixXd& targets, const GpConfig& config,
            const std::vector<int>& row_groups = {});

}  // namespace raven_correction
