// SPDX-License-Identifier: BSD-3-Clause
// Exact and sparse posteriors.
#include "raven_correction/regression/posterior.h"

#include <algorithm>

#include "raven_correction/error.h"
#include "raven_correction/regression/dense.h"
#include "raven_correction/regression/kernel_matrix.h"
#include "raven_correction/regression/marginal_likelihood.h"

namespace raven_correction {
namespace {

constexpr Eigen::Index kBlock = 2048;  // rows that go through the sparse statistics at once

// Cholesky factor of C(X, X) + ridge I in the lower triangle, and the jitter it took.
double factorCorrelation(KernelType kernel, const Eigen::MatrixXd& scaled, double ridge,
                         Eigen::MatrixXd& K) {
  for (double jitter = 0.0; jitter >= 0.0; jitter = nextJitter(jitter)) {
    kernelMatrixLower(kernel, scaled, K, nullptr);
    K.diagonal().array() += ridge + jitter;
    if (factorCholesky(K.rows(), K.data(), K.rows()) == 0) return jitter;
  }
  throw InvalidInput(
      format("correlation matrix of %td points is not positive definite even with 1e-4 on its "
             "diagonal; are the features finite and the length scales positive?",
             K.rows()));
}

void zeroUpper(Eigen::MatrixXd& matrix) { matrix.triangularView<Eigen::StrictlyUpper>().setZero(); }

void checkSizes(const Eigen::MatrixXd& points, const Eigen::MatrixXd& targets,
                const GpGroup& group) {
  if (points.cols() != targets.rows() || points.rows() != group.length_scales.size() ||
      targets.cols() != group.signal_variance.size())
    throw InvalidInput(
        format("%td x %td points and %td x %td targets do not fit a group of %td "
               "features and %td outputs",
               points.rows(), points.cols(), targets.rows(), targets.cols(),
               group.length_scales.size(), group.signal_variance.size()));
}

}  // namespace

double noiseRatio(const GpGroup& group) {
  for (Eigen::Index k = 0; k < group.signal_variance.size(); ++k)
    if (group.signal_variance(k) > 0.0) return group.noise_variance(k) / group.signal_variance(k);
  return 1.0;
}

double conditionExact(const Eigen::MatrixXd& points, const Eigen::MatrixXd& targets,
                      GpGroup& group) {
  checkSizes(points, targets, group);
  const Eigen::Index n = points.cols();
  group.points = points;
  const double jitter = factorCorrelation(group.kernel, scalePoints(points, group.length_scales),
                                          noiseRatio(group), group.variance_factor);
  double* const L = group.variance_factor.data();
  group.weights = targets - evaluateMean(group.mean_weights, points);
  solveLower(Transpose::kNo, n, targets.cols(), L, n, group.weights.data(), n);
  solveLower(Transpose::kYes, n, targets.cols(), L, n, group.weights.data(), n);
  invertLower(n, L, n);
  zeroUpper(group.variance_factor);
  return jitter;
}

SparseStatistics::SparseStatistics(const GpGroup& group, const Eigen::MatrixXd& inducing)
    : group_(group), scaled_(scalePoints(inducing, group.length_scales)) {
  const Eigen::Index m = inducing.cols();
  group_.points = inducing;
  group_.weights.resize(0, 0);
  group_.variance_factor.resize(0, 0);
  jitter_ = factorCorrelation(group.kernel, scaled_, 0.0, L_);
  A_.setZero(m, m);
  b_.setZero(m, group.signal_variance.size());
}

void SparseStatistics::update(const Eigen::MatrixXd& points, const Eigen::MatrixXd& targets,
                              double sign) {
  checkSizes(points, targets, group_);
  const Eigen::Index m = scaled_.cols();
  Eigen::MatrixXd V;
  for (Eigen::Index first = 0; first < points.cols(); first += kBlock) {
    const Eigen::Index count = std::min(kBlock, points.cols() - first);
    const Eigen::MatrixXd block = points.middleCols(first, count);
    kernelMatrix(group_.kernel, scaled_, scalePoints(block, group_.length_scales), V);
    solveLower(Transpose::kNo, m, count, L_.data(), m, V.data(), m);
    const Eigen::MatrixXd residual =
        targets.middleRows(first, count) - evaluateMean(group_.mean_weights, block);
    multiplySymmetric(Transpose::kNo, m, count, sign, V.data(), m, 1.0, A_.data(), m);
    multiply(Transpose::kNo, Transpose::kNo, m, b_.cols(), count, sign, V.data(), m,
             residual.data(), count, 1.0, b_.data(), m);
  }
  rows_ += sign * double(points.cols());
}

GpGroup SparseStatistics::posterior() const {
  const Eigen::Index m = scaled_.cols();
  const double rho = noiseRatio(group_);
  GpGroup group = group_;

  Eigen::MatrixXd E = A_ / rho;
  E.diagonal().array() += 1.0;
  if (factorCholesky(m, E.data(), m) != 0)
    throw InvalidInput(
        format("rows were taken away that had not been added: %.0f rows are left "
               "and the posterior is not positive definite",
               rows_));
  group.weights = b_ / rho;
  solveLower(Transpose::kNo, m, b_.cols(), E.data(), m, group.weights.data(), m);
  solveLower(Transpose::kYes, m, b_.cols(), E.data(), m, group.weights.data(), m);
  solveLower(Transpose::kYes, m, b_.cols(), L_.data(), m, group.weights.data(), m);

  // I - E^-1 = F F' with F upper triangular, so that T = F' L^-1 is lower triangular: reverse the
  // order of rows and columns, factor, reverse back. Its eigenvalues lie in [0, 1); 1e-14 keeps
  // directions without any data from rounding below zero, and changes no variance by more.
  invertLower(m, E.data(), m);
  multiplyInverseFactor(m, E.data(), m);
  Eigen::MatrixXd reversed(m, m);
  for (Eigen::Index j = 0; j < m; ++j)
    for (Eigen::Index i = j; i < m; ++i) reversed(m - 1 - j, m - 1 - i) = -E(i, j);
  for (double jitter = 1e-14; jitter >= 0.0; jitter = nextJitter(jitter)) {
    E = reversed;
    E.diagonal().array() += 1.0 + jitter;
    if (factorCholesky(m, E.data(), m) == 0) break;
  }
  group.variance_factor.setZero(m, m);  // F'
  for (Eigen::Index j = 0; j < m; ++j)
    for (Eigen::Index i = j; i < m; ++i) group.variance_factor(m - 1 - j, m - 1 - i) = E(i, j);
  // T = F' L^-1, so T' = L^-T F.
  Eigen::MatrixXd transposed = group.variance_factor.transpose();
  solveLower(Transpose::kYes, m, m, L_.data(), m, transposed.data(), m);
  group.variance_factor = transposed.transpose();
  zeroUpper(group.variance_factor);
  return group;
}

}  // namespace raven_correction
