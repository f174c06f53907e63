// SPDX-License-Identifier: BSD-3-Clause
// How probable the targets are under given hyper-parameters, and in which direction that grows.
// Finding the best hyper-parameters is hyperparameters.h.
#pragma once

#include <Eigen/Core>

#include "raven_correction/regression/kernel.h"
#include "raven_correction/regression/mean_function.h"

namespace raven_correction {

/// Log marginal likelihood of q outputs that share a correlation K = C + rho I (n x n).
///
///   y_k ~ N(H b_k, s_k^2 K),   K = L L'
///   b_k   = (H'K^-1 H)^-1 H'K^-1 y_k          generalised least squares
///   s_k^2 = r_k'K^-1 r_k / n,  r_k = y_k - H b_k
///   value = -1/2 sum_k ( n log 2 pi + n log s_k^2 + log |K| + n )
///
/// The signal variances s_k^2 and the mean weights b_k take their best values in closed form, so
/// only log length scales and log rho remain, and the gradient is that of fixed s_k^2 and b_k.
/// All length scales cost one product:  with M = G o (sum_k a_k a_k'/s_k^2 - q K^-1), a_k = K^-1
/// r_k and G from kernel.h,
///   d value / d log l_j = sum_a x_aj^2 (M 1)_a - x_j'M x_j,   x in units of l
///   d value / d log rho = rho/2 ( sum_k |a_k|^2/s_k^2 - q tr K^-1 )
/// Source: Rasmussen, Williams 2006, sections 2.7 and 5.4.1, isbn 026218253X.
class MarginalLikelihood {
 public:
  /// @param points   d x n, best centred;  targets: n x q
  /// @param ard      one length scale per feature; false: one for all
  MarginalLikelihood(KernelType kernel, MeanType mean, bool ard, const Eigen::MatrixXd& points,
                     const Eigen::MatrixXd& targets);

  /// Number of parameters: log l_1 ... log l_d (or log l), log rho.
  Eigen::Index parameters() const { return (ard_ ? points_.rows() : 1) + 1; }

  const Eigen::MatrixXd& targets() const { return targets_; }

  /// @param log_parameters  in the order of parameters()
  /// @param gradient        resized; may be null
  /// @return the log marginal likelihood [nat]; -infinity where K has no Cholesky factor
  double evaluate(const Eigen::VectorXd& log_parameters, Eigen::VectorXd* gradient);

  /// Of the last evaluation: s_k^2; b_k (columns of the basis x q); jitter added to K.
  const Eigen::VectorXd& signalVariance() const { return signal_variance_; }
  const Eigen::MatrixXd& meanWeights() const { return mean_weights_; }
  double jitter() const { return jitter_; }

 private:
  bool factor(const Eigen::MatrixXd& scaled, double noise_ratio, Eigen::MatrixXd* slope);
  Eigen::VectorXd gradientOf(const Eigen::MatrixXd& scaled, double noise_ratio,
                             const Eigen::MatrixXd& slope, const Eigen::MatrixXd& alpha);

  KernelType kernel_;
  bool ard_;
  Eigen::MatrixXd points_;
  Eigen::MatrixXd targets_;
  Eigen::MatrixXd basis_;
  Eigen::VectorXd variance_floor_;
  Eigen::MatrixXd K_;  ///< correlation, then its factor, then its inverse; lower triangle
  Eigen::MatrixXd slope_;
  Eigen::VectorXd signal_variance_;
  Eigen::MatrixXd mean_weights_;
  double jitter_ = 0.0;
};

/// Jitter to try next when a correlation matrix has no Cholesky factor: 0, 1e-12, 1e-11 ... 1e-4.
/// @return a negative number when there is nothing left to try
double nextJitter(double jitter) noexcept;

}  // namespace raven_correction
