// SPDX-License-Identifier: BSD-3-Clause
// Correlation matrices from differences of coordinates: no cancellation between near points.
// Columns go to threads in blocks; one block is one call of the vectorised loop.
#include "raven_correction/regression/kernel_matrix.h"

#include <omp.h>

#include <algorithm>

#include "simd_kernels.h"

namespace raven_correction {
namespace {

constexpr Eigen::Index kPadding = 16;    // points that the loop may read past the last
constexpr Eigen::Index kColumns = 32;    // of one block
constexpr double kWorkForThreads = 1e5;  // pairs below which one thread is faster

int threadsFor(double pairs) {
  return pairs < kWorkForThreads || omp_in_parallel() ? 1 : omp_get_max_threads();
}

// One feature after the other, (n + kPadding) x d.
Eigen::MatrixXd featureMajor(const Eigen::MatrixXd& points) {
  Eigen::MatrixXd result = Eigen::MatrixXd::Zero(points.cols() + kPadding, points.rows());
  result.topRows(points.cols()) = points.transpose();
  return result;
}

}  // namespace

Eigen::MatrixXd scalePoints(const Eigen::MatrixXd& points, const Eigen::VectorXd& length_scales) {
  return length_scales.cwiseInverse().asDiagonal() * points;
}

void kernelMatrix(KernelType type, const Eigen::MatrixXd& a, const Eigen::MatrixXd& b,
                  Eigen::MatrixXd& C) {
  const Eigen::Index d = a.rows();
  const Eigen::Index n = a.cols();
  const Eigen::Index m = b.cols();
  C.resize(n, m);
  const Eigen::MatrixXd by_feature = featureMajor(a);
  const SimdKernels& simd = simdKernels();
  const int threads = threadsFor(double(n) * double(m));
#pragma omp parallel for schedule(dynamic, 1) num_threads(threads) if (threads > 1)
  for (Eigen::Index j = 0; j < m; j += kColumns)
    simd.correlations(int(type), d, n, by_feature.data(), by_feature.rows(),
                      std::min(kColumns, m - j), b.data() + j * d, d, C.data() + j * n, nullptr, n);
}

void kernelMatrixLower(KernelType type, const Eigen::MatrixXd& a, Eigen::MatrixXd& C,
                       Eigen::MatrixXd* G) {
  const Eigen::Index d = a.rows();
  const Eigen::Index n = a.cols();
  C.resize(n, n);
  if (G != nullptr) G->resize(n, n);
  const Eigen::MatrixXd by_feature = featureMajor(a);
  const SimdKernels& simd = simdKernels();
  const int threads = threadsFor(0.5 * double(n) * double(n));
#pragma omp parallel for schedule(dynamic, 1) num_threads(threads) if (threads > 1)
  for (Eigen::Index j = 0; j < n; j += kColumns)
    simd.correlations(int(type), d, n - j, by_feature.data() + j, by_feature.rows(),
                      std::min(kColumns, n - j), a.data() + j * d, d, C.data() + j + j * n,
                      G != nullptr ? G->data() + j + j * n : nullptr, n);
}

}  // namespace raven_correction
