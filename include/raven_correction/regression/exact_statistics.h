// SPDX-License-Identifier: BSD-3-Clause
// The exact posterior of rows that come and go: the Cholesky factor is grown and shrunk, not made
// anew. A fixed set of rows is conditioned on by posterior.h, which also has the sparse posterior
// of rows that come and go.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "raven_correction/regression/gaussian_process.h"

namespace raven_correction {

/// Rows in order of arrival, K = C(X, X) + rho I = L L', z = L^-1 (Y - [1 X'] B).
///
///   k rows more:  V = L^-1 C(X, X2),  S S' = K22 - V'V,   L <- [L 0; V' S],
///                 z <- [z; S^-1 (y2 - V'z)],              O(n^2 k)
///   r rows less:  L = [A 0; W B]: the factor of what is left is that of B B' + W W', by orthogonal
///                 transformations [B W] Q = [L 0] of blocks of columns, O(n^2 r)
///
/// Memory: room for an eighth more rows than at first; when that is used up, adding copies it once.
/// Source of the second: Golub, Van Loan 2013, Matrix Computations, section 6.5.4, isbn 1421407949
class ExactStatistics {
 public:
  /// @param group  kernel, length_scales, mean_weights and signal/noise variances are read
  /// @param points  d x n, n > 0;  targets: n x outputs of the group
  /// @throws InvalidInput  sizes differ, or K is not positive definite with any jitter
  ExactStatistics(const GpGroup& group, const Eigen::MatrixXd& points,
                  const Eigen::MatrixXd& targets);

  /// @throws InvalidInput  as the constructor; then nothing has changed
  void append(const Eigen::MatrixXd& points, const Eigen::MatrixXd& targets);

  /// @param count  0 to rows() - 1
  void dropOldest(Eigen::Index count);

  Eigen::Index rows() const { return points_.cols(); }
  double jitter() const { return jitter_; }
  const GpGroup& group() const { return group_; }

  /// As conditionExact() of the same rows, ordered by varianceOrder().
  GpGroup posterior(Eigen::Index variance_points = 0) const;

 private:
  void factorAll(const Eigen::MatrixXd& points, const Eigen::MatrixXd& residual);
  void reserve(Eigen::Index rows);
  bool appendToFactor(const Eigen::MatrixXd& points, const Eigen::MatrixXd& residual);

  GpGroup group_;
  Eigen::MatrixXd points_;    ///< d x n
  Eigen::MatrixXd residual_;  ///< n x outputs: targets minus mean function
  Eigen::MatrixXd L_;         ///< capacity x capacity; rows() x rows() in the lower triangle
  Eigen::MatrixXd z_;         ///< n x outputs
  double jitter_ = 0.0;
};

/// Order of rows in which the first ones stand for all, whatever came when: by a hash of their
/// features. A row keeps its place relative to the others when rows are added or taken away, so
/// training anew and online learning agree on the rows that the variance uses.
/// @param points  d x n
/// @return n column indices
std::vector<Eigen::Index> varianceOrder(const Eigen::MatrixXd& points);

}  // namespace raven_correction
