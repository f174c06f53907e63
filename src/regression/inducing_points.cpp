// SPDX-License-Identifier: BSD-3-Clause
// Greedy choice of inducing points by conditional variance.
#include "raven_correction/regression/inducing_points.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>

#include "raven_correction/regression/dense.h"
#include "raven_correction/regression/kernel_matrix.h"

namespace raven_correction {
namespace {

constexpr double kKnown = 1e-10;     // conditional variance of a row that adds nothing [-]
constexpr Eigen::Index kBlock = 64;  // rows whose covariances are computed in one product
constexpr double kGreed = 0.8;  // a block is left when the best row outside is this much better

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
  std::vector<Eigen::Index> block;
  Eigen::MatrixXd columns;
  Eigen::Index k = 0;
  while (k < count) {
    // Covariances of the most uncertain rows with all, given the points chosen before the block.
    const double largest = remaining.maxCoeff();
    if (k > 0 && !(largest > kKnown)) break;
    block = sampleIndices(n, n, 0);
    const Eigen::Index size = std::min(kBlock, n);
    std::partial_sort(block.begin(), block.begin() + size, block.end(),
                      [&](Eigen::Index i, Eigen::Index j) {
                        return remaining(i) != remaining(j) ? remaining(i) > remaining(j) : i < j;
                      });
    block.resize(std::size_t(size));
    kernelMatrix(kernel, points, selectColumns(points, block), columns);
    if (k > 0) {  // rows of a matrix without columns are nowhere
      Eigen::MatrixXd block_factor(size, k);
      for (Eigen::Index s = 0; s < size; ++s)
        block_factor.row(s) = factor.row(block[std::size_t(s)]).head(k);
      multiply(Transpose::kNo, Transpose::kYes, n, size, k, -1.0, factor.data(), n,
               block_factor.data(), size, 1.0, columns.data(), n);
    }
    // Points of the block one by one, as long as they are about as uncertain as the best of all.
    const Eigen::Index start = k;
    while (k < count) {
      Eigen::Index best = 0;
      for (Eigen::Index s = 1; s < size; ++s)
        if (remaining(block[std::size_t(s)]) > remaining(block[std::size_t(best)])) best = s;
      const Eigen::Index pivot = block[std::size_t(best)];
      const double variance = remaining(pivot);
      if (k > start && !(variance > std::max(kKnown, kGreed * remaining.maxCoeff()))) break;
      factor.col(k) = columns.col(best);
      if (k > start)
        factor.col(k).noalias() -= factor.middleCols(start, k - start) *
                                   factor.row(pivot).segment(start, k - start).transpose();
      factor.col(k) /= std::sqrt(variance);
      remaining -= factor.col(k).cwiseAbs2();
      remaining(pivot) = 0.0;
      chosen.push_back(candidates[std::size_t(pivot)]);
      ++k;
    }
  }
  return chosen;
}

}  // namespace raven_correction
