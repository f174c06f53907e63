// SPDX-License-Identifier: BSD-3-Clause
// Dense linear algebra on raw column-major memory: products, Cholesky factor, triangular solves.
// No Eigen in the interface, so that the code behind it may be compiled for several instruction
// sets; covariance matrices are kernel_matrix.h.
#pragma once

#include <cstddef>

namespace raven_correction {

/// Sizes and strides of matrices; element (i, j) of A is a[i + j * lda].
using DenseIndex = std::ptrdiff_t;
enum class Transpose { kNo, kYes };

/// C = alpha op(A) op(B) + beta C; op(A) is m x k, op(B) is k x n, C is m x n. beta = 0 does not
/// read C.
void multiply(Transpose transpose_a, Transpose transpose_b, DenseIndex m, DenseIndex n,
              DenseIndex k, double alpha, const double* a, DenseIndex lda, const double* b,
              DenseIndex ldb, double beta, double* c, DenseIndex ldc);

/// Lower triangle of C = alpha op(A) op(A)' + beta C; op(A) is n x k. The strict upper triangle
/// of C is neither read nor written.
void multiplySymmetric(Transpose transpose, DenseIndex n, DenseIndex k, double alpha,
                       const double* a, DenseIndex lda, double beta, double* c, DenseIndex ldc);

/// A = L L' in place, lower triangles only.
/// @return 0, or the 1-based index of the first pivot that is not positive (A is then undefined)
DenseIndex factorCholesky(DenseIndex n, double* a, DenseIndex lda);

/// B = op(L)^-1 B for n x columns B.
void solveLower(Transpose transpose, DenseIndex n, DenseIndex columns, const double* l,
                DenseIndex ldl, double* b, DenseIndex ldb);

/// L = L^-1 in place; the strict upper triangle is neither read nor written.
void invertLower(DenseIndex n, double* l, DenseIndex ldl);

/// B = op(L) B for n x columns B, in place.
void multiplyLower(Transpose transpose, DenseIndex n, DenseIndex columns, const double* l,
                   DenseIndex ldl, double* b, DenseIndex ldb);

/// Lower triangle of (L L')^-1 = L^-T L^-1, given L^-1, in place.
void multiplyInverseFactor(DenseIndex n, double* l_inverse, DenseIndex ld);

}  // namespace raven_correction
