// SPDX-License-Identifier: BSD-3-Clause
// Small regression problems with a known truth, shared by the tests of this room.
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <random>

#include "raven_correction/regression/gaussian_process.h"

namespace raven_correction {

/// rows x columns standard normal values; the same for the same seed.
inline Eigen::MatrixXd normalMatrix(Eigen::Index rows, Eigen::Index columns, unsigned seed) {
  std::mt19937_64 engine(seed);
  std::normal_distribution<double> normal;
  Eigen::MatrixXd matrix(rows, columns);
  for (Eigen::Index j = 0; j < columns; ++j)
    for (Eigen::Index i = 0; i < rows; ++i) matrix(i, j) = normal(engine);
  return matrix;
}

/// Two smooth outputs of the first three features (n x d, d >= 3); further features do nothing.
inline Eigen::MatrixXd smoothTargets(const Eigen::MatrixXd& features) {
  Eigen::MatrixXd targets(features.rows(), 2);
  targets.col(0) = (1.5 * features.col(0)).array().sin() + 0.5 * features.col(1).array();
  targets.col(1) =
      10.0 * (features.col(0).array() * 0.7).cos() * (0.5 * features.col(2)).array().sin();
  return targets;
}

/// A group with plausible, not learnt, hyper-parameters for d features and q outputs.
inline GpGroup plainGroup(KernelType kernel, Eigen::Index d, Eigen::Index q, double noise_ratio) {
  GpGroup group;
  group.kernel = kernel;
  for (int k = 0; k < int(q); ++k) group.outputs.push_back(k);
  group.length_scales = Eigen::VectorXd::LinSpaced(d, 1.0, 2.0);
  group.signal_variance = Eigen::VectorXd::LinSpaced(q, 1.0, 4.0);
  group.noise_variance = noise_ratio * group.signal_variance;
  group.mean_weights = Eigen::MatrixXd::Zero(1 + d, q);
  return group;
}

inline GpModel modelOf(const GpGroup& group) {
  GpModel model;
  model.features = int(group.length_scales.size());
  model.outputs = int(group.outputs.size());
  model.groups.push_back(group);
  return model;
}

}  // namespace raven_correction
