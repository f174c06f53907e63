// SPDX-License-Identifier: BSD-3-Clause
// Formulae of the kernels, and whole matrices against one pair at a time.
#include "raven_correction/regression/kernel.h"

#include <gtest/gtest.h>

#include "raven_correction/error.h"
#include "raven_correction/regression/kernel_matrix.h"
#include "sample_problems.h"

namespace raven_correction {
namespace {

constexpr KernelType kKernels[] = {KernelType::kSquaredExponential, KernelType::kMatern32,
                                   KernelType::kMatern52};

TEST(Kernel, ValuesAtOneFromTheFormulae) {
  EXPECT_NEAR(correlation(KernelType::kSquaredExponential, 1.0), 0.60653065971263342, 1e-15);
  EXPECT_NEAR(correlation(KernelType::kMatern32, 1.0), 0.48335772459650765, 1e-15);
  EXPECT_NEAR(correlation(KernelType::kMatern52, 1.0), 0.52399410883182031, 1e-15);
  for (const KernelType kernel : kKernels) EXPECT_EQ(correlation(kernel, 0.0), 1.0);
}

TEST(Kernel, SlopeIsMinusTheDerivativeOverTheDistance) {
  for (const KernelType kernel : kKernels)
    for (const double r : {0.01, 0.3, 1.0, 2.5, 7.0}) {
      const double h = 1e-5 * r;
      const double derivative =
          (correlation(kernel, r + h) - correlation(kernel, r - h)) / (2.0 * h);
      EXPECT_NEAR(-derivative / r, correlationSlope(kernel, r), 1e-9 / (r * r))
          << kernelName(kernel);
    }
}

TEST(Kernel, NamesGoBothWaysAndAWrongOneIsRefused) {
  for (const KernelType kernel : kKernels) EXPECT_EQ(kernelFromName(kernelName(kernel)), kernel);
  EXPECT_THROW(kernelFromName("rbf"), InvalidInput);
}

// Odd sizes leave tails behind every vector width.
TEST(KernelMatrix, EqualsTheScalarFormulaForAnySize) {
  for (const KernelType kernel : kKernels)
    for (const Eigen::Index n : {1, 7, 16, 33})
      for (const Eigen::Index m : {1, 5, 40})
        for (const Eigen::Index d : {1, 3, 12}) {
          const Eigen::MatrixXd a = normalMatrix(d, n, 1);
          Eigen::MatrixXd b = normalMatrix(d, m, 2) * 3.0;
          b.col(0) = a.col(0);
          Eigen::MatrixXd C;
          kernelMatrix(kernel, a, b, C);
          ASSERT_EQ(C.rows(), n);
          ASSERT_EQ(C.cols(), m);
          for (Eigen::Index i = 0; i < n; ++i)
            for (Eigen::Index j = 0; j < m; ++j)
              ASSERT_NEAR(C(i, j), correlation(kernel, (a.col(i) - b.col(j)).norm()), 1e-14);
        }
}

TEST(KernelMatrix, LowerTriangleAndSlopes) {
  for (const KernelType kernel : kKernels)
    for (const Eigen::Index n : {1, 9, 67}) {
      const Eigen::MatrixXd a = normalMatrix(5, n, 3);
      Eigen::MatrixXd C;
      Eigen::MatrixXd G;
      kernelMatrixLower(kernel, a, C, &G);
      for (Eigen::Index j = 0; j < n; ++j)
        for (Eigen::Index i = j; i < n; ++i) {
          const double r = (a.col(i) - a.col(j)).norm();
          ASSERT_NEAR(C(i, j), correlation(kernel, r), 1e-14);
          ASSERT_NEAR(G(i, j), correlationSlope(kernel, r), 1e-14);
        }
    }
}

TEST(KernelMatrix, FarAndHugeDistancesGiveZeroNotNan) {
  Eigen::MatrixXd a(1, 3);
  a << 0.0, 1e3, 1e150;
  Eigen::MatrixXd b(1, 1);
  b << 0.0;
  for (const KernelType kernel : kKernels) {
    Eigen::MatrixXd C;
    kernelMatrix(kernel, a, b, C);
    EXPECT_EQ(C(0, 0), 1.0);
    EXPECT_NEAR(C(1, 0), 0.0, 1e-300);
    EXPECT_NEAR(C(2, 0), 0.0, 1e-300);
  }
}

}  // namespace
}  // namespace raven_correction
