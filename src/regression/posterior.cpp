// SPDX-License-Identifier: BSD-3-Clause
// Exact and sparse posteriors.
#include "raven_correction/regression/posterior.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "raven_correction/error.h"
#include "raven_correction/regression/dense.h"
#include "raven_correction/regression/kernel_matrix.h"
#include "raven_correction/regression/marginal_likelihood.h"

namespace raven_correction {
namespace {

constexpr Eigen::Index kBlock = 2048;  // rows that go through the sparse statistics at once

void zeroUpper(Eigen::MatrixXd& matrix) { matrix.triangularView<Eigen::StrictlyUpper>().setZero(); }

}  // namespace

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

void checkRows(const Eigen::MatrixXd& points, const Eigen::MatrixXd& targets,
               const GpGroup& group) {
  if (points.cols() != targets.rows() || points.rows() != group.length_scales.size() ||
      targets.cols() != group.signal_variance.size())
    throw InvalidInput(
        format("%td x %td points and %td x %td targets do not fit a group of %td "
               "features and %td outputs",
               points.rows(), points.cols(), targets.rows(), targets.cols(),
               group.length_scales.size(), group.signal_variance.size()));
}

Eigen::MatrixXd groupTargets(const GpGroup& group, const Eigen::MatrixXd& targets) {
  Eigen::MatrixXd selected(targets.rows(), Eigen::Index(group.outputs.size()));
  for (std::size_t k = 0; k < group.outputs.size(); ++k)
    selected.col(Eigen::Index(k)) = targets.col(group.outputs[k]);
  return selected;
}

double noiseRatio(const GpGroup& group) {
  for (Eigen::Index k = 0; k < group.signal_variance.size(); ++k)
    if (group.signal_variance(k) > 0.0) return group.noise_variance(k) / group.signal_variance(k);
  return 1.0;
}

double conditionExact(const Eigen::MatrixXd& points, const Eigen::MatrixXd& targets, GpGroup& group,
                      Eigen::Index variance_points) {
  checkRows(points, targets, group);
  const Eigen::Index n = points.cols();
  group.points = points;
  const double jitter = factorCorrelation(group.kernel, scalePoints(points, group.length_scales),
                                          noiseRatio(group), group.variance_factor);
  double* const L = group.variance_factor.data();
  group.weights = targets - evaluateMean(group.mean_weights, points);
  solveLower(Transpose::kNo, n, targets.cols(), L, n, group.weights.data(), n);
  solveLower(Transpose::kYes, n, targets.cols(), L, n, group.weights.data(), n);
  // The factor of a leading block is the leading block of the factor.
  if (variance_points > 0 && variance_points < n)
    group.variance_factor =
        group.variance_factor.topLeftCorner(variance_points, variance_points).eval();
  const Eigen::Index used = group.variance_factor.rows();
  invertLower(used, group.variance_factor.data(), used);
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
  squares_.setZero(group.signal_variance.size());
}

void SparseStatistics::update(const Eigen::MatrixXd& points, const Eigen::MatrixXd& targets,
                              double sign) {
  checkRows(points, targets, group_);
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
    squares_ += sign * residual.colwise().squaredNorm().transpose();
  }
  rows_ += sign * double(points.cols());
}

double SparseStatistics::valueAt(double noise_ratio, Eigen::VectorXd& signal_variance) const {
  const Eigen::Index m = scaled_.cols();
  const double n = rows_;
  Eigen::MatrixXd E = A_ / noise_ratio;
  E.diagonal().array() += 1.0;
  if (factorCholesky(m, E.data(), m) != 0) return -std::numeric_limits<double>::infinity();
  Eigen::MatrixXd projected = b_;
  solveLower(Transpose::kNo, m, b_.cols(), E.data(), m, projected.data(), m);
  const double log_determinant = n * std::log(noise_ratio) + 2.0 * E.diagonal().array().log().sum();
  double value = 0.0;
  for (Eigen::Index k = 0; k < b_.cols(); ++k) {
    const double square =
        (squares_(k) - projected.col(k).squaredNorm() / noise_ratio) / noise_ratio;
    if (!(squares_(k) > 0.0)) {  // an output that is zero everywhere says nothing
      signal_variance(k) = 0.0;
      continue;
    }
    signal_variance(k) = std::max(square / n, 1e-20 * squares_(k) / n);
    value -= 0.5 * (n * std::log(2.0 * M_PI * signal_variance(k)) + log_determinant + n);
  }
  return value;
}

double SparseStatistics::learnNoise() {
  // Golden section on the logarithm: the value has one maximum in practice, and a local one is
  // still better than the noise of few rows.
  constexpr double kGolden = 0.6180339887498949;
  constexpr double kResolution = 0.02;
  double low = std::log(1e-8);
  double high = std::log(1e2);
  Eigen::VectorXd signal_variance = group_.signal_variance;
  const auto value = [&](double x) { return valueAt(std::exp(x), signal_variance); };
  double left = high - kGolden * (high - low);
  double right = low + kGolden * (high - low);
  double value_left = value(left);
  double value_right = value(right);
  while (high - low > kResolution) {
    if (value_left > value_right) {
      high = right;
      right = left;
      value_right = value_left;
      left = high - kGolden * (high - low);
      value_left = value(left);
    } else {
      low = left;
      left = right;
      value_left = value_right;
      right = low + kGolden * (high - low);
      value_right = value(right);
    }
  }
  const double noise_ratio = std::exp(0.5 * (low + high));
  const double best = valueAt(noise_ratio, signal_variance);
  group_.signal_variance = signal_variance;
  group_.noise_variance = noise_ratio * signal_variance;
  return best;
}

GpGroup SparseStatistics::posterior(Eigen::Index variance_points) const {
  const Eigen::Index m = scaled_.cols();
  const Eigen::Index mv = variance_points > 0 ? std::min(variance_points, m) : m;
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

  // From here on of the first mv points.
  // I - E^-1 = F F' with F upper triangular, so that T = F' L^-1 is lower triangular: reverse the
  // order of rows and columns, factor, reverse back. Its eigenvalues lie in [0, 1); 1e-14 keeps
  // directions without any data from rounding below zero, and changes no variance by more.
  E.conservativeResize(mv, mv);  // the leading part of a factor is the factor of the leading part
  invertLower(mv, E.data(), mv);
  multiplyInverseFactor(mv, E.data(), mv);
  Eigen::MatrixXd reversed(mv, mv);
  for (Eigen::Index j = 0; j < mv; ++j)
    for (Eigen::Index i = j; i < mv; ++i) reversed(mv - 1 - j, mv - 1 - i) = -E(i, j);
  for (double jitter = 1e-14; jitter >= 0.0; jitter = nextJitter(jitter)) {
    E = reversed;
    E.diagonal().array() += 1.0 + jitter;
    if (factorCholesky(mv, E.data(), mv) == 0) break;
  }
  Eigen::MatrixXd F = Eigen::MatrixXd::Zero(mv, mv);
  for (Eigen::Index j = 0; j < mv; ++j)
    for (Eigen::Index i = j; i < mv; ++i) F(mv - 1 - i, mv - 1 - j) = E(i, j);
  solveLower(Transpose::kYes, mv, mv, L_.data(), m, F.data(), mv);  // T' = L^-T F
  group.variance_factor = F.transpose();
  zeroUpper(group.variance_factor);
  return group;
}

}  // namespace raven_correction
