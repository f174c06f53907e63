// SPDX-License-Identifier: BSD-3-Clause
// The deterministic part of a Gaussian process: nothing, a constant or a plane. Its weights are
// estimated together with the covariance (hyperparameters.h).
#pragma once

#include <Eigen/Core>
#include <string>

namespace raven_correction {

enum class MeanType { kZero, kConstant, kLinear };
/// "zero", "constant", "linear".
/// @throws InvalidInput  for any other name; the text lists these
MeanType meanFromName(const std::string& name);

/// Basis of the mean at each point: n x 0, n x 1 (ones) or n x (1 + d) ([1 x']).
/// @param points  d x n
Eigen::MatrixXd meanBasis(MeanType type, const Eigen::MatrixXd& points);

/// [1 x'] B for every point, n x outputs. B: (1 + d) x outputs, always of that size; a zero or
/// constant mean has zeros in it.
Eigen::MatrixXd evaluateMean(const Eigen::MatrixXd& mean_weights, const Eigen::MatrixXd& points);

}  // namespace raven_correction
