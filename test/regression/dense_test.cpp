// SPDX-License-Identifier: BSD-3-Clause
// Products, factors and solves against plain Eigen, at sizes around every block edge, and every
// compiled instruction set against the portable one.
#include "raven_correction/regression/dense.h"

#include <gtest/gtest.h>

#include <Eigen/LU>

#include "../../src/regression/simd_kernels.h"
#include "raven_correction/regression/kernel.h"
#include "sample_problems.h"

namespace raven_correction {
namespace {

constexpr Eigen::Index kSizes[] = {1, 2, 7, 24, 63, 64, 65, 97, 200, 301};

double largest(const Eigen::MatrixXd& matrix) { return matrix.cwiseAbs().maxCoeff(); }

// Well conditioned lower triangle with junk above its diagonal that nobody may read.
Eigen::MatrixXd lowerTriangle(Eigen::Index n) {
  Eigen::MatrixXd L = normalMatrix(n, n, 11) / std::sqrt(double(n));
  L.diagonal() = L.diagonal().cwiseAbs().array() + 1.0;
  L.triangularView<Eigen::StrictlyUpper>().setConstant(1e100);
  return L;
}

Eigen::MatrixXd clean(const Eigen::MatrixXd& L) { return L.triangularView<Eigen::Lower>(); }

// What lies in memory so that op() of it is `matrix`.
Eigen::MatrixXd stored(const Eigen::MatrixXd& matrix, Transpose transpose) {
  if (transpose == Transpose::kNo) return matrix;
  return matrix.transpose();
}

TEST(Dense, ProductsOfAnyShapeAndTransposition) {
  for (const Eigen::Index m : kSizes)
    for (const Eigen::Index n : {1, 5, 8, 130})
      for (const Eigen::Index k : {1, 9, 256, 300})
        for (const Transpose ta : {Transpose::kNo, Transpose::kYes})
          for (const Transpose tb : {Transpose::kNo, Transpose::kYes}) {
            const Eigen::MatrixXd A = normalMatrix(m, k, 1);
            const Eigen::MatrixXd B = normalMatrix(k, n, 2);
            Eigen::MatrixXd C = normalMatrix(m + 3, n, 3);  // stride larger than the rows
            Eigen::MatrixXd expected = C;
            expected.topRows(m) = 0.5 * C.topRows(m) - 2.0 * A * B;
            const Eigen::MatrixXd a = stored(A, ta);
            const Eigen::MatrixXd b = stored(B, tb);
            multiply(ta, tb, m, n, k, -2.0, a.data(), a.rows(), b.data(), b.rows(), 0.5, C.data(),
                     C.rows());
            ASSERT_LT(largest(C - expected), 1e-11 * double(k)) << m << " " << n << " " << k;
          }
}

TEST(Dense, BetaZeroDoesNotReadC) {
  const Eigen::MatrixXd A = normalMatrix(20, 20, 1);
  Eigen::MatrixXd C = Eigen::MatrixXd::Constant(20, 20, std::nan(""));
  multiply(Transpose::kNo, Transpose::kNo, 20, 20, 20, 1.0, A.data(), 20, A.data(), 20, 0.0,
           C.data(), 20);
  EXPECT_LT(largest(C - A * A), 1e-12);
}

TEST(Dense, SymmetricProductWritesTheLowerTriangleOnly) {
  for (const Eigen::Index n : kSizes)
    for (const Transpose t : {Transpose::kNo, Transpose::kYes}) {
      const Eigen::MatrixXd A = normalMatrix(n, 33, 1);
      const Eigen::MatrixXd a = stored(A, t);
      Eigen::MatrixXd C = normalMatrix(n, n, 2);
      Eigen::MatrixXd expected = C;
      expected.triangularView<Eigen::Lower>() = 3.0 * A * A.transpose() - C;
      multiplySymmetric(t, n, 33, 3.0, a.data(), a.rows(), -1.0, C.data(), n);
      ASSERT_LT(largest(C - expected), 1e-11) << n;
    }
}

TEST(Dense, CholeskyFactorMultipliesBack) {
  for (const Eigen::Index n : kSizes) {
    const Eigen::MatrixXd L = clean(lowerTriangle(n));
    Eigen::MatrixXd A = L * L.transpose();
    A.triangularView<Eigen::StrictlyUpper>().setConstant(7.0);
    ASSERT_EQ(factorCholesky(n, A.data(), n), 0);
    EXPECT_LT(largest(clean(A) - L), 1e-12 * double(n)) << n;
    for (Eigen::Index j = 1; j < n; ++j) ASSERT_EQ(A(j - 1, j), 7.0);
  }
}

TEST(Dense, CholeskyNamesTheFirstBadPivot) {
  for (const Eigen::Index bad : {0, 5, 63, 64, 130, 199}) {
    Eigen::MatrixXd A = Eigen::MatrixXd::Identity(200, 200);
    A(bad, bad) = bad % 2 == 0 ? -1.0 : std::nan("");
    EXPECT_EQ(factorCholesky(200, A.data(), 200), bad + 1);
  }
}

TEST(Dense, SolvesAndTriangularProducts) {
  for (const Eigen::Index n : kSizes)
    for (const Eigen::Index columns : {1, 3, 4, 6, 8, 9, 70}) {
      const Eigen::MatrixXd L = lowerTriangle(n);
      const Eigen::MatrixXd T = clean(L);
      const Eigen::MatrixXd X = normalMatrix(n, columns, 5);
      Eigen::MatrixXd B = T * X;
      solveLower(Transpose::kNo, n, columns, L.data(), n, B.data(), n);
      EXPECT_LT(largest(B - X), 1e-10) << n;
      B = T.transpose() * X;
      solveLower(Transpose::kYes, n, columns, L.data(), n, B.data(), n);
      EXPECT_LT(largest(B - X), 1e-10) << n;
      B = X;
      multiplyLower(Transpose::kNo, n, columns, L.data(), n, B.data(), n);
      EXPECT_LT(largest(B - T * X), 1e-11) << n;
      B = X;
      multiplyLower(Transpose::kYes, n, columns, L.data(), n, B.data(), n);
      EXPECT_LT(largest(B - T.transpose() * X), 1e-11) << n;
    }
}

TEST(Dense, ManyRowsForFewColumnsAreSolvedByThreads) {
  const Eigen::Index n = 2600;
  const Eigen::MatrixXd L = lowerTriangle(n);
  const Eigen::MatrixXd X = normalMatrix(n, 6, 5);
  Eigen::MatrixXd B = clean(L).transpose() * X;
  solveLower(Transpose::kYes, n, 6, L.data(), n, B.data(), n);
  EXPECT_LT(largest(B - X), 1e-9);
}

TEST(Dense, InversesOfATriangleAndOfItsProduct) {
  for (const Eigen::Index n : kSizes) {
    Eigen::MatrixXd L = lowerTriangle(n);
    const Eigen::MatrixXd T = clean(L);
    invertLower(n, L.data(), n);
    EXPECT_LT(largest(clean(L) * T - Eigen::MatrixXd::Identity(n, n)), 1e-11) << n;
    if (n > 1) {
      EXPECT_EQ(L(0, 1), 1e100);
    }
    const Eigen::MatrixXd inverse = clean(L);
    multiplyInverseFactor(n, L.data(), n);
    EXPECT_LT(largest(clean(L) - clean(inverse.transpose() * inverse)), 1e-11) << n;
  }
}

class InstructionSet : public ::testing::TestWithParam<const char*> {
 protected:
  void SetUp() override {
    set_ = simdKernels(GetParam());
    if (set_ == nullptr) GTEST_SKIP() << GetParam() << " does not run on this machine";
  }
  const SimdKernels* set_ = nullptr;
};

TEST_P(InstructionSet, TileEqualsTheDefinition) {
  const Eigen::MatrixXd A = normalMatrix(set_->tile_rows, 37, 1);
  const Eigen::MatrixXd B = normalMatrix(set_->tile_columns, 37, 2);
  Eigen::MatrixXd C = normalMatrix(set_->tile_rows + 1, set_->tile_columns, 3);
  Eigen::MatrixXd expected = C;
  expected.topRows(set_->tile_rows) += 0.5 * A * B.transpose();
  set_->tile(37, 0.5, A.data(), B.data(), C.data(), C.rows());
  EXPECT_LT(largest(C - expected), 1e-12);
}

// exp to one unit in the last place over the whole range that correlations use.
TEST_P(InstructionSet, CorrelationsToRounding) {
  for (int kernel = 0; kernel < 3; ++kernel)
    for (const Eigen::Index n : {1, 15, 16, 17, 1000}) {
      Eigen::MatrixXd a = Eigen::MatrixXd::Zero(n + 16, 1);  // one feature, from 0 to 50
      for (Eigen::Index i = 0; i < n; ++i) a(i, 0) = 50.0 * double(i) / double(n);
      const double b[5] = {0.0, 0.5, 3.0, -2.0, 1e-9};
      Eigen::MatrixXd c = Eigen::MatrixXd::Constant(n + 1, 5, -7.0);
      Eigen::MatrixXd g = c;
      set_->correlations(kernel, 1, n, a.data(), n + 16, 5, b, 1, c.data(), g.data(), n + 1);
      for (Eigen::Index j = 0; j < 5; ++j) {
        EXPECT_EQ(c(n, j), -7.0);  // nothing written past the end
        for (Eigen::Index i = 0; i < n; ++i) {
          const double r = std::abs(a(i, 0) - b[j]);
          // The argument of exp carries its own rounding, up to |log c| units.
          const auto type = static_cast<KernelType>(kernel);
          const double expected = correlation(type, r);
          const double units = 4.0 + 2.0 * std::abs(std::log(expected + 1e-307));
          ASSERT_NEAR(c(i, j), expected, units * 2.3e-16 * expected + 1e-305) << r;
          ASSERT_NEAR(g(i, j), correlationSlope(type, r), units * 7e-16 * expected + 1e-305) << r;
        }
      }
    }
}

TEST_P(InstructionSet, SquaredNormOfATriangularProduct) {
  for (const Eigen::Index n : {1, 31, 32, 33, 100}) {
    const Eigen::MatrixXd T = clean(lowerTriangle(n));
    const Eigen::Index rows = set_->panel_rows;
    const Eigen::Index padded = (n + rows - 1) / rows * rows;
    std::vector<double> panels;
    for (Eigen::Index first = 0; first < n; first += rows)
      for (Eigen::Index column = 0; column < first + rows; ++column)
        for (Eigen::Index i = first; i < first + rows; ++i)
          panels.push_back(i < n && column < n ? T(i, column) : 0.0);
    Eigen::VectorXd x = Eigen::VectorXd::Zero(padded);
    x.head(n) = normalMatrix(n, 1, 9);
    const double expected = (T * x.head(n)).squaredNorm();
    EXPECT_NEAR(set_->squaredNormLower(n, panels.data(), x.data()), expected, 1e-12 * expected);
  }
}

INSTANTIATE_TEST_SUITE_P(All, InstructionSet,
                         ::testing::Values("portable", "x86-64-v2", "x86-64-v3", "x86-64-v4"));

}  // namespace
}  // namespace raven_correction
