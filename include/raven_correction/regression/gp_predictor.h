// SPDX-License-Identifier: BSD-3-Clause
// Answers of a learnt Gaussian process: immutable, shared by any number of threads, and free of
// allocation once the workspace exists. Learning is gaussian_process.h.
#pragma once

#include <Eigen/Core>
#include <memory>

#include "raven_correction/regression/gaussian_process.h"

namespace raven_correction {

class GpPredictor {
 public:
  /// Scratch memory of one caller; make it once per thread with makeWorkspace().
  class Workspace;

  /// @throws InvalidInput  sizes inside the model do not fit together, or a value is not finite
  explicit GpPredictor(GpModel model);
  ~GpPredictor();
  GpPredictor(GpPredictor&&) noexcept;
  GpPredictor& operator=(GpPredictor&&) noexcept;

  int features() const noexcept;  ///< d
  int outputs() const noexcept;   ///< q
  /// Prior standard deviation of each latent output, q: what is answered far from all data.
  const Eigen::VectorXd& priorDeviation() const noexcept;
  std::shared_ptr<Workspace> makeWorkspace() const;

  /// Mean and variance of the latent function for one query. No allocation, lock or throw.
  /// @param x         d features
  /// @param mean      q values, written
  /// @param variance  q values, written, >= 0; may be nullptr
  void predict(const double* x, double* mean, double* variance,
               Workspace& workspace) const noexcept;

  /// The same for n queries at once, threaded.
  /// @param x  n x d;  mean, variance: resized to n x q; variance may be nullptr
  void predict(const Eigen::MatrixXd& x, Eigen::MatrixXd& mean, Eigen::MatrixXd* variance) const;

 private:
  struct Impl;
  std::unique_ptr<const Impl> impl_;
};

}  // namespace raven_correction
