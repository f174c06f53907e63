// SPDX-License-Identifier: BSD-3-Clause
// Growing and shrinking a Cholesky factor.
#include "raven_correction/regression/exact_statistics.h"

#include <Eigen/QR>
#include <algorithm>
#include <cstring>
#include <numeric>

#include "raven_correction/error.h"
#include "raven_correction/regression/dense.h"
#include "raven_correction/regression/inducing_points.h"
#include "raven_correction/regression/kernel_matrix.h"
#include "raven_correction/regression/marginal_likelihood.h"
#include "raven_correction/regression/posterior.h"

namespace raven_correction {
namespace {

constexpr Eigen::Index kRoom = 256;   // rows that always fit before memory is copied
constexpr Eigen::Index kBlock = 128;  // columns of the factor that one transformation mends

// The mixing step of splitmix64 after each value.
// Source: Steele et al. 2014, doi:10.1145/2660193.2660195
std::uint64_t hashOf(const double* values, Eigen::Index count) {
  std::uint64_t hash = 0;
  for (Eigen::Index i = 0; i < count; ++i) {
    std::uint64_t bits = 0;
    const double value = values[i] + 0.0;  // no negative zero
    std::memcpy(&bits, &value, sizeof(bits));
    hash = (hash ^ bits) + 0x9e3779b97f4a7c15ULL;
    hash = (hash ^ (hash >> 30)) * 0xbf58476d1ce4e5b9ULL;
    hash = (hash ^ (hash >> 27)) * 0x94d049bb133111ebULL;
    hash ^= hash >> 31;
  }
  return hash;
}

// Orthogonal Q with A Q = [L 0], L lower triangular with a positive diagonal.
Eigen::MatrixXd transformationOf(const Eigen::MatrixXd& A) {
  const Eigen::HouseholderQR<Eigen::MatrixXd> qr(A.transpose());
  Eigen::MatrixXd Q = qr.householderQ();
  for (Eigen::Index j = 0; j < A.rows(); ++j)
    if (qr.matrixQR()(j, j) < 0.0) Q.col(j) = -Q.col(j);
  return Q;
}

}  // namespace

std::vector<Eigen::Index> varianceOrder(const Eigen::MatrixXd& points) {
  std::vector<std::uint64_t> hashes;
  for (Eigen::Index i = 0; i < points.cols(); ++i)
    hashes.push_back(hashOf(points.col(i).data(), points.rows()));
  std::vector<Eigen::Index> order(hashes.size());
  std::iota(order.begin(), order.end(), Eigen::Index(0));
  std::stable_sort(order.begin(), order.end(), [&](Eigen::Index a, Eigen::Index b) {
    return hashes[std::size_t(a)] < hashes[std::size_t(b)];
  });
  return order;
}

ExactStatistics::ExactStatistics(const GpGroup& group, const Eigen::MatrixXd& points,
                                 const Eigen::MatrixXd& targets)
    : group_(group) {
  group_.points.resize(0, 0);
  group_.weights.resize(0, 0);
  group_.variance_factor.resize(0, 0);
  checkRows(points, targets, group_);
  factorAll(points, targets - evaluateMean(group_.mean_weights, points));
}

void ExactStatistics::factorAll(const Eigen::MatrixXd& points, const Eigen::MatrixXd& residual) {
  const Eigen::Index n = points.cols();
  Eigen::MatrixXd K;
  const double jitter = factorCorrelation(group_.kernel, scalePoints(points, group_.length_scales),
                                          noiseRatio(group_), K);
  const Eigen::Index capacity = std::max(L_.rows(), n + std::max(kRoom, n / 8));
  L_.setZero(capacity, capacity);  // every page is touched now, not when rows are added
  L_.topLeftCorner(n, n) = K;
  jitter_ = jitter;
  points_ = points;
  residual_ = residual;
  z_ = residual;
  solveLower(Transpose::kNo, n, z_.cols(), L_.data(), capacity, z_.data(), n);
}

void ExactStatistics::reserve(Eigen::Index rows) {
  if (rows <= L_.rows()) return;
  const Eigen::Index n = this->rows();
  const Eigen::Index capacity = rows + std::max(kRoom, rows / 8);
  Eigen::MatrixXd larger = Eigen::MatrixXd::Zero(capacity, capacity);
  larger.topLeftCorner(n, n) = L_.topLeftCorner(n, n);
  L_ = std::move(larger);
}

bool ExactStatistics::appendToFactor(const Eigen::MatrixXd& points,
                                     const Eigen::MatrixXd& residual) {
  const Eigen::Index n = rows(), k = points.cols(), q = residual.cols(), ld = L_.rows();
  const Eigen::MatrixXd fresh = scalePoints(points, group_.length_scales);
  Eigen::MatrixXd V, S;
  kernelMatrix(group_.kernel, scalePoints(points_, group_.length_scales), fresh, V);
  solveLower(Transpose::kNo, n, k, L_.data(), ld, V.data(), n);
  kernelMatrixLower(group_.kernel, fresh, S, nullptr);
  S.diagonal().array() += noiseRatio(group_) + jitter_;
  multiplySymmetric(Transpose::kYes, k, n, -1.0, V.data(), n, 1.0, S.data(), k);
  if (factorCholesky(k, S.data(), k) != 0) return false;
  Eigen::MatrixXd z = residual;
  multiply(Transpose::kYes, Transpose::kNo, k, q, n, -1.0, V.data(), n, z_.data(), n, 1.0, z.data(),
           k);
  solveLower(Transpose::kNo, k, q, S.data(), k, z.data(), k);

  L_.block(n, 0, k, n) = V.transpose();
  for (Eigen::Index j = 0; j < k; ++j) L_.col(n + j).segment(n + j, k - j) = S.col(j).tail(k - j);
  z_.conservativeResize(n + k, q);
  z_.bottomRows(k) = z;
  return true;
}

void ExactStatistics::append(const Eigen::MatrixXd& points, const Eigen::MatrixXd& targets) {
  checkRows(points, targets, group_);
  if (points.cols() == 0) return;
  const Eigen::Index n = rows();
  const Eigen::MatrixXd residual = targets - evaluateMean(group_.mean_weights, points);
  Eigen::MatrixXd all_points(points.rows(), n + points.cols());
  all_points << points_, points;
  Eigen::MatrixXd all_residual(n + points.cols(), residual.cols());
  all_residual << residual_, residual;
  reserve(n + points.cols());
  if (!appendToFactor(points, residual)) {  // the whole matrix needs a larger jitter
    factorAll(all_points, all_residual);
    return;
  }
  points_ = std::move(all_points);
  residual_ = std::move(all_residual);
}

void ExactStatistics::dropOldest(Eigen::Index count) {
  if (count < 0 || count >= rows())
    throw InvalidInput(
        format("%td oldest rows to drop of %td; at least one must stay", count, rows()));
  if (count == 0) return;
  const Eigen::Index left = rows() - count, q = z_.cols(), ld = L_.rows();
  // Rows of `rest`: what W still has to give to each row of the factor, and to z.
  Eigen::MatrixXd rest(left + q, count);
  rest.topRows(left) = L_.block(count, 0, left, count);
  rest.bottomRows(q) = z_.topRows(count).transpose();
  Eigen::MatrixXd strip, mended;
  for (Eigen::Index j = 0; j < left; j += kBlock) {
    const Eigen::Index b = std::min(kBlock, left - j), rows = left - j, width = b + count;
    double* const block = L_.data() + (count + j) + (count + j) * ld;
    strip.setZero(rows + q, width);
    for (Eigen::Index s = 0; s < b; ++s)
      std::copy(block + s + s * ld, block + rows + s * ld, strip.col(s).data() + s);
    strip.bottomRows(q).leftCols(b) = z_.middleRows(count + j, b).transpose();
    strip.rightCols(count) = rest.bottomRows(rows + q);
    const Eigen::MatrixXd Q = transformationOf(strip.topRows(b));
    mended.resize(rows + q, width);
    multiply(Transpose::kNo, Transpose::kNo, rows + q, width, width, 1.0, strip.data(), rows + q,
             Q.data(), width, 0.0, mended.data(), rows + q);
    for (Eigen::Index s = 0; s < b; ++s)
      std::copy(mended.col(s).data() + s, mended.col(s).data() + rows, block + s + s * ld);
    z_.middleRows(count + j, b) = mended.bottomRows(q).leftCols(b).transpose();
    rest.bottomRows(rows + q) = mended.rightCols(count);
  }
  for (Eigen::Index j = 0; j < left; ++j)
    std::copy(L_.data() + (count + j) + (count + j) * ld, L_.data() + rows() + (count + j) * ld,
              L_.data() + j + j * ld);
  points_ = points_.rightCols(left).eval();
  residual_ = residual_.bottomRows(left).eval();
  z_ = z_.bottomRows(left).eval();
}

GpGroup ExactStatistics::posterior(Eigen::Index variance_points) const {
  const Eigen::Index n = rows(), ld = L_.rows();
  Eigen::MatrixXd weights = z_;
  solveLower(Transpose::kYes, n, weights.cols(), L_.data(), ld, weights.data(), n);
  const std::vector<Eigen::Index> order = varianceOrder(points_);
  GpGroup group = group_;
  group.points = selectColumns(points_, order);
  group.weights = selectRows(weights, order);
  const Eigen::Index used = variance_points > 0 ? std::min(variance_points, n) : n;
  factorCorrelation(group.kernel, scalePoints(group.points.leftCols(used), group.length_scales),
                    noiseRatio(group) + jitter_, group.variance_factor);
  invertLower(used, group.variance_factor.data(), used);
  group.variance_factor.triangularView<Eigen::StrictlyUpper>().setZero();
  return group;
}

}  // namespace raven_correction
