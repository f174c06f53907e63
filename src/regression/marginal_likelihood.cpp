// SPDX-License-Identifier: BSD-3-Clause
// Log marginal likelihood and its gradient: one Cholesky factor, one inverse, one product.
#include "raven_correction/regression/marginal_likelihood.h"

#include <Eigen/QR>
#include <cmath>
#include <limits>

#include "raven_correction/regression/dense.h"
#include "raven_correction/regression/kernel_matrix.h"

namespace raven_correction {

double nextJitter(double jitter) noexcept {
  if (jitter == 0.0) return 1e-12;
  return jitter < 0.5e-4 ? 10.0 * jitter : -1.0;
}

MarginalLikelihood::MarginalLikelihood(KernelType kernel, MeanType mean, bool ard,
                                       const Eigen::MatrixXd& points,
                                       const Eigen::MatrixXd& targets)
    : kernel_(kernel),
      ard_(ard),
      points_(points),
      targets_(targets),
      basis_(meanBasis(mean, points)),
      // Targets that the mean explains to rounding would drive s^2 to zero and log s^2 to -inf.
      variance_floor_(
          (1e-20 * targets.colwise().squaredNorm().transpose() / double(points.cols())).array() +
          std::numeric_limits<double>::min()) {}

bool MarginalLikelihood::factor(const Eigen::MatrixXd& scaled, double noise_ratio,
                                Eigen::MatrixXd* slope) {
  for (jitter_ = 0.0; jitter_ >= 0.0; jitter_ = nextJitter(jitter_)) {
    kernelMatrixLower(kernel_, scaled, K_, slope);
    K_.diagonal().array() += noise_ratio + jitter_;
    if (factorCholesky(K_.rows(), K_.data(), K_.rows()) == 0) return true;
  }
  return false;
}

double MarginalLikelihood::evaluate(const Eigen::VectorXd& log_parameters,
                                    Eigen::VectorXd* gradient) {
  const Eigen::Index n = points_.cols();
  const Eigen::Index q = targets_.cols();
  const double noise_ratio = std::exp(log_parameters(log_parameters.size() - 1));
  const Eigen::VectorXd length_scales =
      ard_ ? log_parameters.head(points_.rows()).array().exp().matrix().eval()
           : Eigen::VectorXd::Constant(points_.rows(), std::exp(log_parameters(0)));
  if (gradient != nullptr) gradient->setZero(parameters());
  const Eigen::MatrixXd scaled = scalePoints(points_, length_scales);
  if (!log_parameters.allFinite() || !std::isfinite(noise_ratio) || !scaled.allFinite() ||
      !factor(scaled, noise_ratio, gradient != nullptr ? &slope_ : nullptr))
    return -std::numeric_limits<double>::infinity();

  Eigen::MatrixXd residual = targets_;
  solveLower(Transpose::kNo, n, q, K_.data(), n, residual.data(), n);
  mean_weights_.setZero(basis_.cols(), q);
  if (basis_.cols() > 0) {
    Eigen::MatrixXd basis = basis_;
    solveLower(Transpose::kNo, n, basis.cols(), K_.data(), n, basis.data(), n);
    mean_weights_ = basis.completeOrthogonalDecomposition().solve(residual);
    residual -= basis * mean_weights_;
  }
  const Eigen::VectorXd squares = residual.colwise().squaredNorm();
  signal_variance_ = (squares / double(n)).cwiseMax(variance_floor_);
  const double log_determinant = 2.0 * K_.diagonal().array().log().sum();
  const double value =
      -0.5 *
      (double(n * q) * std::log(2.0 * M_PI) + double(n) * signal_variance_.array().log().sum() +
       double(q) * log_determinant + (squares.array() / signal_variance_.array()).sum());
  if (gradient != nullptr) {
    solveLower(Transpose::kYes, n, q, K_.data(), n, residual.data(), n);
    *gradient = gradientOf(scaled, noise_ratio, slope_, residual);
  }
  return value;
}

Eigen::VectorXd MarginalLikelihood::gradientOf(const Eigen::MatrixXd& scaled, double noise_ratio,
                                               const Eigen::MatrixXd& slope,
                                               const Eigen::MatrixXd& alpha) {
  const Eigen::Index n = scaled.cols();
  const Eigen::Index d = scaled.rows();
  const double q = double(alpha.cols());
  invertLower(n, K_.data(), n);
  multiplyInverseFactor(n, K_.data(), n);
  const Eigen::MatrixXd alpha_scaled =
      alpha * signal_variance_.cwiseInverse().cwiseSqrt().asDiagonal();

  Eigen::VectorXd gradient(parameters());
  gradient(gradient.size() - 1) =
      0.5 * noise_ratio * (alpha_scaled.squaredNorm() - q * K_.diagonal().sum());

  // K_ becomes M = G o (sum_k a_k a_k' / s_k^2 - q K^-1), both triangles.
  multiplySymmetric(Transpose::kNo, n, alpha.cols(), 1.0, alpha_scaled.data(), n, -q, K_.data(), n);
  for (Eigen::Index j = 0; j < n; ++j) {
    K_.col(j).tail(n - j).array() *= slope.col(j).tail(n - j).array();
    K_.row(j).tail(n - j) = K_.col(j).tail(n - j).transpose();
  }
  const Eigen::MatrixXd points = scaled.transpose();
  Eigen::MatrixXd product(n, d);
  multiply(Transpose::kNo, Transpose::kNo, n, d, n, 1.0, K_.data(), n, points.data(), n, 0.0,
           product.data(), n);
  const Eigen::VectorXd row_sums = K_.rowwise().sum();
  const Eigen::VectorXd by_scale =
      (points.array() * (row_sums.asDiagonal() * points - product).array()).colwise().sum();
  if (ard_)
    gradient.head(d) = by_scale;
  else
    gradient(0) = by_scale.sum();
  return gradient;
}

}  // namespace raven_correction
