// SPDX-License-Identifier: BSD-3-Clause
// Greedy choice of inducing points by conditional variance.
#include "raven_correction/regression/inducing_points.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>

#include "raven_correction/regression/kernel_matrix.h"

namespace raven_correction {
namespace {

constexpr double kKnown = 1e-10;  // conditional variance of a row that adds nothing [-]

}  // namespace

std::vector<Eigen::Index> sampleIndices(Eigen::Index n, Eigen::Index count, std::uint64_t seed) {
  std::vector<Eigen::Index> indices(static_cast<std::size_t>(n));
  std::iota(indices.begin(), indices.end(), Eigen::Index(0));
  if (count >= n) return indices;
  // Fisher-Yates on the first `count` places. Modulo, because distributions differ between
  // standard libraries; its bias is below n / 2^64.
  std::mt19937_64 engine(seed);
  for (Eigen::Index i = 0; i < count; ++i) {
    const auto j = i + Eigen::Index(engine() % std::uint64_t(n - i));
    std::swap(indices[std::size_t(i)], indices[std::size_t(j)]);
  }
  indices.resize(std::size_t(count));
  std::sort(indices.begin(), indices.end());
  return indices;
}

Eigen::MatrixXd selectColumns(const Eigen::MatrixXd& matrix,
                              const std::vector<Eigen::Index>& indices) {
  Eigen::MatrixXd selected(matrix.rows(), Eigen::Index(indices.size()));
  for (std::size_t i = 0; i < indices.size(); ++i)
    selected.col(Eigen::Index(i)) = matrix.col(indices[i]);
  return selected;
}

Eigen::MatrixXd selectRows(const Eigen::MatrixXd& matrix,
                           const std::vector<Eigen::Index>& indices) {
  Eigen::MatrixXd selected(Eigen::Index(indices.size()), matrix.cols());
  for (std::size_t i = 0; i < indices.size(); ++i)
    selected.row(Eigen::Index(i)) = matrix.row(indices[i]);
  return selected;
}

std::vector<Eigen::Index> chooseInducingPoints(KernelType kernel, const Eigen::MatrixXd& scaled,
                                               Eigen::Index count, Eigen::Index max_candidates,
                                               std::uint64_t seed) {
  const std::vector<Eigen::Index> candidates = sampleIndices(scaled.cols(), max_candidates, seed);
  const Eigen::MatrixXd points = selectColumns(scaled, candidates);
  const Eigen::Index n = points.cols();
  count = std::min(count, n);
  Eigen::MatrixXd factor(n, count);  // column k: k-th column of the pivoted Cholesky factor
  Eigen::VectorXd remaining = Eigen::VectorXd::Ones(n);
  std::vector<Eigen::Index> chosen;
  Eigen::MatrixXd column;
  for (Eigen::Index k = 0; k < count; ++k) {
    Eigen::Index pivot = 0;
    const double largest = remaining.maxCoeff(&pivot);
    if (k > 0 && !(largest > kKnown)) break;
    chosen.push_back(candidates[std::size_t(pivot)]);
    kernelMatrix(kernel, points, points.col(pivot), column);
    column.noalias() -= factor.leftCols(k) * factor.row(pivot).head(k).transpose();
    factor.col(k) = column / std::sqrt(largest);
    remaining -= factor.col(k).cwiseAbs2();
    remaining(pivot) = 0.0;
  }
  return chosen;
}

}  // namespace raven_correction
