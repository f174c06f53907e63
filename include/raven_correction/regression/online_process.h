// SPDX-License-Identifier: BSD-3-Clause
// A Gaussian process that rows are added to and taken from while it is in use. The first fit is
// gaussian_process.h; the hyper-parameters and inducing points stay those of that fit.
#pragma once

#include <Eigen/Core>
#include <deque>
#include <variant>
#include <vector>

#include "raven_correction/regression/exact_statistics.h"
#include "raven_correction/regression/gaussian_process.h"
#include "raven_correction/regression/posterior.h"

namespace raven_correction {

/// The result is that of conditioning on all rows at once. Sparse: keeps the sufficient statistics
/// of each group (posterior.h), so that k rows cost O(m^2 k + m^3) however many are in it. Exact:
/// keeps the Cholesky factor (exact_statistics.h), k rows cost O(n^2 k), and are in the model as
/// points of their own; drop as many old ones to keep queries as fast as they are.
class OnlineProcess {
 public:
  /// @param model     kSparse: its points are the inducing points
  /// @param features  n x d, targets: n x q: the rows it was trained on (GpFit::posterior_rows),
  ///        oldest first
  /// @param backend   that the model was trained with
  /// @throws InvalidInput  sizes do not fit the model, or a value is not finite
  OnlineProcess(const GpModel& model, const Eigen::MatrixXd& features,
                const Eigen::MatrixXd& targets, GpBackend backend = GpBackend::kSparse);

  /// Adds rows as the newest. The model is untouched when this throws.
  /// @throws InvalidInput  as the constructor
  void add(const Eigen::MatrixXd& features, const Eigen::MatrixXd& targets);

  /// Takes away the oldest rows.
  /// @throws InvalidInput  there are not that many, or (exact) none would be left
  void dropOldest(Eigen::Index count);

  Eigen::Index rows() const { return Eigen::Index(rows_.size()); }

  /// The model conditioned on the rows that are in it now.
  GpModel model() const;

 private:
  struct Row {
    Eigen::VectorXd features;
    Eigen::VectorXd targets;
  };
  void check(const Eigen::MatrixXd& features, const Eigen::MatrixXd& targets) const;
  void remember(const Eigen::MatrixXd& features, const Eigen::MatrixXd& targets);
  int features_ = 0;
  int outputs_ = 0;
  std::vector<std::variant<SparseStatistics, ExactStatistics>> groups_;
  std::vector<Eigen::Index> variance_points_;
  std::deque<Row> rows_;
};

}  // namespace raven_correction
