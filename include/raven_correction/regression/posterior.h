// SPDX-License-Identifier: BSD-3-Clause
// From hyper-parameters and data to what a prediction needs: weights and variance factor, exact
// or through inducing points. Learning the hyper-parameters is hyperparameters.h.
#pragma once

#include <Eigen/Core>

#include "raven_correction/regression/gaussian_process.h"

namespace raven_correction {

/// Exact posterior of one group. Reads kernel, length_scales, signal_variance, noise_variance and
/// mean_weights of `group`; writes points, weights and variance_factor.
///
///   K = C(X, X) + rho I = L L',   weights = K^-1 (Y - [1 X'] B),   variance_factor = L^-1
///
/// @param points   d x n;  targets: n x outputs of the group
/// @param variance_points  the variance is that of conditioning on the first so many points alone
///        (never smaller than that of all); 0: all
/// @return jitter that had to be added to K [-]
/// @throws InvalidInput  sizes differ, or K is not positive definite with any jitter
/// Source: Rasmussen, Williams 2006, algorithm 2.1, isbn 026218253X
double conditionExact(const Eigen::MatrixXd& points, const Eigen::MatrixXd& targets, GpGroup& group,
                      Eigen::Index variance_points = 0);

/// Sufficient statistics of any number of rows for a fixed set of m inducing points Z: rows can be
/// added and taken away in any order, at a cost that does not depend on the rows already in it.
///
///   C(Z, Z) = L L',  v(x) = L^-1 c(Z, x),  A = sum v v',  b = sum v (y - [1 x'] B)'
class SparseStatistics {
 public:
  SparseStatistics() = default;
  /// @param group    kernel, length_scales, mean_weights and signal/noise variances are read
  /// @param inducing d x m
  /// @throws InvalidInput  C(Z, Z) is not positive definite with any jitter
  SparseStatistics(const GpGroup& group, const Eigen::MatrixXd& inducing);

  /// @param points  d x n;  targets: n x outputs;  sign: +1 adds the rows, -1 takes them away
  void update(const Eigen::MatrixXd& points, const Eigen::MatrixXd& targets, double sign);

  /// Posterior of the variational approximation with Z: the exact one when Z are the data.
  ///
  ///   E = I + A / rho,   weights = L^-T E^-1 b / rho
  ///   variance_factor T, lower triangular, T'T = L^-T (I - E^-1) L^-1
  ///
  /// The mean uses all of Z, at a cost of m per query; the variance, at m^2, may use the first of
  /// them only: L, v and A of the first points are the leading parts of those of all.
  ///
  /// @param variance_points  points that the variance uses; 0: all
  /// @return the group with points = Z, weights and variance_factor
  /// Source: Titsias 2009, Variational learning of inducing variables in sparse Gaussian
  ///         processes, equations 6 and 10
  GpGroup posterior(Eigen::Index variance_points = 0) const;

  /// Noise ratio and signal variances that make all rows most probable under the approximation;
  /// length scales and mean stay. With K = Q + rho I, Q = V'V of all rows:
  ///
  ///   value(rho) = -1/2 sum_k ( n log 2 pi + n log s_k^2 + log |K| + n ),  s_k^2 = y_k'K^-1 y_k /
  ///   n log |K| = n log rho + log |E|,   y'K^-1 y = (y'y - b'E^-1 b / rho) / rho
  ///
  /// Hyper-parameters learnt on few rows know little of the noise: between distant rows of smooth
  /// recordings everything looks like signal. The other rows, and what Z cannot represent, decide.
  /// @return value at the maximum [nat]
  double learnNoise();

  double jitter() const { return jitter_; }
  double rows() const { return rows_; }
  const GpGroup& group() const { return group_; }

 private:
  double valueAt(double noise_ratio, Eigen::VectorXd& signal_variance) const;

  GpGroup group_;
  Eigen::MatrixXd scaled_;   ///< Z in units of the length scales, d x m
  Eigen::MatrixXd L_;        ///< m x m, lower triangle
  Eigen::MatrixXd A_;        ///< m x m, lower triangle
  Eigen::MatrixXd b_;        ///< m x outputs
  Eigen::VectorXd squares_;  ///< y'y per output
  double jitter_ = 0.0;
  double rows_ = 0.0;
};

/// Cholesky factor of C(X, X) + ridge I.
/// @param scaled  d x n points in units of the length scales
/// @param K       resized to n x n; the factor in its lower triangle
/// @return jitter that had to be added to the diagonal, too [-]
/// @throws InvalidInput  not positive definite with any jitter
double factorCorrelation(KernelType kernel, const Eigen::MatrixXd& scaled, double ridge,
                         Eigen::MatrixXd& K);

/// @param points  d x n;  targets: n x outputs of the group
/// @throws InvalidInput  sizes do not fit together
void checkRows(const Eigen::MatrixXd& points, const Eigen::MatrixXd& targets, const GpGroup& group);

/// Columns of n x q targets that belong to the group, in its order.
Eigen::MatrixXd groupTargets(const GpGroup& group, const Eigen::MatrixXd& targets);

/// rho: noise over signal variance of a group, from its first output that has any signal [-].
double noiseRatio(const GpGroup& group);

}  // namespace raven_correction
