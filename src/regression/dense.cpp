// SPDX-License-Identifier: BSD-3-Clause
// Cholesky factors, triangular solves and inverses: each splits its triangle in two until a small
// one is left, so that nearly all work is done by the products of dense_product.cpp. Small
// diagonal triangles are inverted and multiplied with, which keeps solves at the speed of products.
#include "raven_correction/regression/dense.h"

#include <omp.h>

#include <algorithm>
#include <vector>

#include "simd_kernels.h"

namespace raven_correction {
namespace {

constexpr DenseIndex kSmall = 64;            // order of a triangle that is not split
constexpr DenseIndex kFewColumns = 3;        // right-hand sides that are solved one by one
constexpr DenseIndex kFewSides = 8;          // for which L' is best read once, not packed
constexpr DenseIndex kChunk = 16;            // its columns that one thread takes
constexpr double kValuesForThreads = 1.5e5;  // of L; a barrier on a busy machine costs much more

// About half, a multiple of kSmall.
DenseIndex split(DenseIndex n) { return (n / 2 + kSmall - 1) / kSmall * kSmall; }

// Copy of an m x n block, kept by the thread between calls.
const double* copyOf(DenseIndex m, DenseIndex n, const double* from, DenseIndex ld) {
  static thread_local std::vector<double> memory;
  memory.resize(std::size_t(m * n));
  for (DenseIndex j = 0; j < n; ++j)
    std::copy(from + j * ld, from + j * ld + m, memory.data() + j * m);
  return memory.data();
}

// Inverse of a small lower triangle, kept by the thread until the next call.
const double* smallInverse(DenseIndex n, const double* l, DenseIndex ldl) {
  static thread_local double inverse[kSmall * kSmall];
  simdKernels().smallInverse(n, l, ldl, inverse);
  return inverse;
}

// B = B op(L)^-1 for m x n B: kYes solves X L' = B, kNo solves X L = B.
void solveRight(Transpose transpose, DenseIndex m, DenseIndex n, const double* l, DenseIndex ldl,
                double* b, DenseIndex ldb) {
  if (n <= kSmall) {
    multiply(Transpose::kNo, transpose, m, n, n, 1.0, copyOf(m, n, b, ldb), m,
             smallInverse(n, l, ldl), n, 0.0, b, ldb);
    return;
  }
  const DenseIndex n1 = split(n);
  const double* const l21 = l + n1;
  const double* const l22 = l21 + n1 * ldl;
  double* const b2 = b + n1 * ldb;
  if (transpose == Transpose::kYes) {
    solveRight(transpose, m, n1, l, ldl, b, ldb);
    multiply(Transpose::kNo, Transpose::kYes, m, n - n1, n1, -1.0, b, ldb, l21, ldl, 1.0, b2, ldb);
    solveRight(transpose, m, n - n1, l22, ldl, b2, ldb);
  } else {
    solveRight(transpose, m, n - n1, l22, ldl, b2, ldb);
    multiply(Transpose::kNo, Transpose::kNo, m, n1, n - n1, -1.0, b2, ldb, l21, ldl, 1.0, b, ldb);
    solveRight(transpose, m, n1, l, ldl, b, ldb);
  }
}

void solveOne(Transpose transpose, DenseIndex n, const double* l, DenseIndex ldl, double* b) {
  if (transpose == Transpose::kNo) {
    for (DenseIndex j = 0; j < n; ++j) {
      const double* const column = l + j * ldl;
      const double value = b[j] /= column[j];
      for (DenseIndex i = j + 1; i < n; ++i) b[i] -= value * column[i];
    }
    return;
  }
  for (DenseIndex j = n - 1; j >= 0; --j) {
    const double* const column = l + j * ldl;
    double sum[4] = {b[j], 0.0, 0.0, 0.0};  // several sums, because one waits for itself
    DenseIndex i = j + 1;
    for (; i + 4 <= n; i += 4)
      for (DenseIndex s = 0; s < 4; ++s) sum[s] -= column[i + s] * b[i + s];
    for (; i < n; ++i) sum[0] -= column[i] * b[i];
    b[j] = ((sum[0] + sum[1]) + (sum[2] + sum[3])) / column[j];
  }
}

// B = L^-T B for few columns: from the last block of rows up, each less what those below give it.
void solveFewTransposed(DenseIndex n, DenseIndex columns, const double* l, DenseIndex ldl,
                        double* b, DenseIndex ldb) {
  const SimdKernels& simd = simdKernels();
  for (DenseIndex end = n; end > 0;) {
    const DenseIndex first = (end - 1) / kSmall * kSmall, below = n - end;
    const int threads = double(below) * double(end - first) < kValuesForThreads || omp_in_parallel()
                            ? 1
                            : omp_get_max_threads();
#pragma omp parallel for schedule(static) num_threads(threads) if (threads > 1)
    for (DenseIndex j = first; j < end; j += kChunk)
      simd.subtractTransposed(below, std::min(kChunk, end - j), columns, l + end + j * ldl, ldl,
                              b + end, ldb, b + j, ldb);
    for (DenseIndex k = 0; k < columns; ++k)
      solveOne(Transpose::kYes, end - first, l + first + first * ldl, ldl, b + first + k * ldb);
    end = first;
  }
}

}  // namespace

DenseIndex factorCholesky(DenseIndex n, double* a, DenseIndex lda) {
  if (n <= kSmall) return simdKernels().smallCholesky(n, a, lda);
  const DenseIndex n1 = split(n);
  double* const a21 = a + n1;
  double* const a22 = a21 + n1 * lda;
  const DenseIndex first = factorCholesky(n1, a, lda);
  if (first != 0) return first;
  solveRight(Transpose::kYes, n - n1, n1, a, lda, a21, lda);
  multiplySymmetric(Transpose::kNo, n - n1, n1, -1.0, a21, lda, 1.0, a22, lda);
  const DenseIndex second = factorCholesky(n - n1, a22, lda);
  return second == 0 ? 0 : n1 + second;
}

void solveLower(Transpose transpose, DenseIndex n, DenseIndex columns, const double* l,
                DenseIndex ldl, double* b, DenseIndex ldb) {
  if (transpose == Transpose::kYes && columns <= kFewSides) {
    solveFewTransposed(n, columns, l, ldl, b, ldb);
    return;
  }
  if (columns <= kFewColumns) {
    for (DenseIndex j = 0; j < columns; ++j) solveOne(transpose, n, l, ldl, b + j * ldb);
    return;
  }
  if (n <= kSmall) {
    multiply(transpose, Transpose::kNo, n, columns, n, 1.0, smallInverse(n, l, ldl), n,
             copyOf(n, columns, b, ldb), n, 0.0, b, ldb);
    return;
  }
  const DenseIndex n1 = split(n);
  const double* const l21 = l + n1;
  const double* const l22 = l21 + n1 * ldl;
  double* const b2 = b + n1;
  if (transpose == Transpose::kNo) {
    solveLower(transpose, n1, columns, l, ldl, b, ldb);
    multiply(Transpose::kNo, Transpose::kNo, n - n1, columns, n1, -1.0, l21, ldl, b, ldb, 1.0, b2,
             ldb);
    solveLower(transpose, n - n1, columns, l22, ldl, b2, ldb);
  } else {
    solveLower(transpose, n - n1, columns, l22, ldl, b2, ldb);
    multiply(Transpose::kYes, Transpose::kNo, n1, columns, n - n1, -1.0, l21, ldl, b2, ldb, 1.0, b,
             ldb);
    solveLower(transpose, n1, columns, l, ldl, b, ldb);
  }
}

void multiplyLower(Transpose transpose, DenseIndex n, DenseIndex columns, const double* l,
                   DenseIndex ldl, double* b, DenseIndex ldb) {
  if (n <= kSmall) {
    static thread_local double triangle[kSmall * kSmall];  // with zeros above its diagonal
    for (DenseIndex j = 0; j < n; ++j) {
      std::fill(triangle + j * n, triangle + j * n + j, 0.0);
      std::copy(l + j + j * ldl, l + n + j * ldl, triangle + j + j * n);
    }
    multiply(transpose, Transpose::kNo, n, columns, n, 1.0, triangle, n, copyOf(n, columns, b, ldb),
             n, 0.0, b, ldb);
    return;
  }
  const DenseIndex n1 = split(n);
  const double* const l21 = l + n1;
  const double* const l22 = l21 + n1 * ldl;
  double* const b2 = b + n1;
  if (transpose == Transpose::kNo) {
    multiplyLower(transpose, n - n1, columns, l22, ldl, b2, ldb);
    multiply(Transpose::kNo, Transpose::kNo, n - n1, columns, n1, 1.0, l21, ldl, b, ldb, 1.0, b2,
             ldb);
    multiplyLower(transpose, n1, columns, l, ldl, b, ldb);
  } else {
    multiplyLower(transpose, n1, columns, l, ldl, b, ldb);
    multiply(Transpose::kYes, Transpose::kNo, n1, columns, n - n1, 1.0, l21, ldl, b2, ldb, 1.0, b,
             ldb);
    multiplyLower(transpose, n - n1, columns, l22, ldl, b2, ldb);
  }
}

void invertLower(DenseIndex n, double* l, DenseIndex ldl) {
  if (n <= kSmall) {
    const double* const inverse = smallInverse(n, l, ldl);
    for (DenseIndex j = 0; j < n; ++j)
      std::copy(inverse + j + j * n, inverse + n + j * n, l + j + j * ldl);
    return;
  }
  // The lower left block becomes - L22^-1 L21 L11^-1, with the inverses of its neighbours solved
  // for, not multiplied with: the triangles are still those of L.
  const DenseIndex n1 = split(n);
  double* const l21 = l + n1;
  double* const l22 = l21 + n1 * ldl;
  solveRight(Transpose::kNo, n - n1, n1, l, ldl, l21, ldl);
  solveLower(Transpose::kNo, n - n1, n1, l22, ldl, l21, ldl);
  for (DenseIndex j = 0; j < n1; ++j)
    for (DenseIndex i = 0; i < n - n1; ++i) l21[i + j * ldl] = -l21[i + j * ldl];
  invertLower(n1, l, ldl);
  invertLower(n - n1, l22, ldl);
}

void multiplyInverseFactor(DenseIndex n, double* l_inverse, DenseIndex ld) {
  if (n <= kSmall) {
    static thread_local double product[kSmall * kSmall];
    static thread_local double triangle[kSmall * kSmall];
    for (DenseIndex j = 0; j < n; ++j) {
      std::fill(triangle + j * n, triangle + j * n + j, 0.0);
      std::copy(l_inverse + j + j * ld, l_inverse + n + j * ld, triangle + j + j * n);
    }
    multiplySymmetric(Transpose::kYes, n, n, 1.0, triangle, n, 0.0, product, n);
    for (DenseIndex j = 0; j < n; ++j)
      std::copy(product + j + j * n, product + n + j * n, l_inverse + j + j * ld);
    return;
  }
  // [A 0; B D]'[A 0; B D] = [A'A + B'B, .; D'B, D'D]
  const DenseIndex n1 = split(n);
  double* const b = l_inverse + n1;
  double* const d = b + n1 * ld;
  multiplyInverseFactor(n1, l_inverse, ld);
  multiplySymmetric(Transpose::kYes, n1, n - n1, 1.0, b, ld, 1.0, l_inverse, ld);
  multiplyLower(Transpose::kYes, n - n1, n1, d, ld, b, ld);
  multiplyInverseFactor(n - n1, d, ld);
}

}  // namespace raven_correction
