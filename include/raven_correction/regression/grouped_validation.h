// SPDX-License-Identifier: BSD-3-Clause
// How well a Gaussian process predicts groups of rows that it has not seen, as a function of its
// length scales and noise, with gradient. The other criterion for choosing these is
// marginal_likelihood.h: that one believes that the noise of neighbouring rows is independent,
// which samples of one motion are not, and then takes their common error for signal.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "raven_correction/regression/kernel.h"

namespace raven_correction {

/// Splits the groups into folds; in each, the process conditioned on (at most max_rows of) the
/// other groups predicts (at most max_rows of) the fold's rows:
///
///   e = C(B, A) (C(A, A) + rho I)^-1 Y_A - Y_B
///   value = mean over folds, rows and outputs of sqrt(e^2 + delta^2) - delta
///
/// nearly the mean absolute error, which outliers cannot rule; delta keeps it smooth.
/// Source of the principle: Sundararajan, Keerthi 2001, doi:10.1162/08997660151134343; groups:
///         Roberts et al. 2017, doi:10.1111/ecog.02881
class GroupedValidation {
 public:
  struct Options {
    KernelType kernel = KernelType::kMatern32;
    std::vector<int> blocks;      ///< length parameter of each feature, from 0 without gaps
    int folds = 3;                ///< >= 2; fewer where there are fewer groups
    Eigen::Index max_rows = 700;  ///< on either side of a fold
    double delta = 0.15;          ///< in units of the targets
    std::uint64_t seed = 1;
  };
  /// @param points   d x n, of comparable spread;  targets: n x q, of unit size
  /// @param groups   n numbers; rows with equal numbers belong together
  /// @throws InvalidInput  sizes differ, or fewer than two groups
  GroupedValidation(const Options& options, const Eigen::MatrixXd& points,
                    const Eigen::MatrixXd& targets, const std::vector<int>& groups);

  /// Length parameters and the noise ratio.
  Eigen::Index parameters() const { return lengths_ + 1; }

  /// @param log_parameters  log length of each block, log rho (noise over signal variance)
  /// @param gradient        of the value, or null
  /// @return the value; infinity where a matrix is not positive definite
  double evaluate(const Eigen::VectorXd& log_parameters, Eigen::VectorXd* gradient);

  /// Signal variance of each output that makes intervals honest on the rows left out: the 95 %
  /// quantile of |e| / sqrt(v + rho), v the latent variance in units of the signal variance, is put
  /// to that of the normal distribution.
  Eigen::VectorXd signalVariance(const Eigen::VectorXd& log_parameters);

 private:
  struct Fold {
    Eigen::MatrixXd points;   // d x (a + b): those learnt from, then those predicted
    Eigen::MatrixXd targets;  // (a + b) x q
    Eigen::Index learn = 0;   // a
  };
  bool condition(const Fold& fold, const Eigen::VectorXd& log_parameters, bool with_slope);
  double addFold(const Fold& fold, double rho, Eigen::VectorXd* gradient);

  Options options_;
  Eigen::Index lengths_ = 0;
  std::vector<Fold> folds_;
  // Of the fold that was conditioned last.
  Eigen::MatrixXd scaled_, C_, G_, factor_, cross_, alpha_;
};

}  // namespace raven_correction
