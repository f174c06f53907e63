// SPDX-License-Identifier: BSD-3-Clause
// The inner loops that decide the speed of this room, compiled once per instruction set and chosen
// at run time. Blocking and threads around them are dense.cpp and kernel_matrix.cpp.
#pragma once

#include <cstddef>

namespace raven_correction {

/// One compiled set. Pointers are plain, matrices column-major; nothing allocates or throws.
struct SimdKernels {
  using Index = std::ptrdiff_t;

  const char* name;  ///< "x86-64-v4", "x86-64-v3", "x86-64-v2" or "portable"
  Index tile_rows;   ///< MR of `tile`
  Index tile_columns;
  Index panel_rows;  ///< rows of one panel of `squaredNormLower`

  /// C += alpha A B for one MR x NR tile. a: k steps of MR values; b: k steps of NR values.
  void (*tile)(Index k, double alpha, const double* a, const double* b, double* c, Index ldc);

  /// Correlations of n points with m others, and slopes unless `slopes` is null (kernel.h).
  /// @param kernel  0, 1, 2 as KernelType
  /// @param a  coordinate f of point i is a[f * lda + i]; readable up to 16 points past n
  /// @param b  coordinate f of point j is b[f + j * ldb]
  /// @param c, slopes  value (i, j) is c[i + j * ldc]
  void (*correlations)(int kernel, Index d, Index n, const double* a, Index lda, Index m,
                       const double* b, Index ldb, double* c, double* slopes, Index ldc);

  /// C -= A'B for few columns of B: each value of A is read from memory once.
  /// @param a  rows x columns;  b: rows x q;  c: columns x q
  void (*subtractTransposed)(Index rows, Index columns, Index q, const double* a, Index lda,
                             const double* b, Index ldb, double* c, Index ldc);

  /// || T x ||^2 for a lower triangular T of n rows. panels: panel after panel of `panel_rows`
  /// rows; panel p has the columns before (p + 1) * panel_rows, each `panel_rows` values, zero
  /// above the diagonal and below the last row. x: readable and zero up to a whole panel.
  double (*squaredNormLower)(Index n, const double* panels, const double* x);

  /// Cholesky factor of a small matrix, in place, lower triangle; 0 or the 1-based bad pivot.
  Index (*smallCholesky)(Index n, double* a, Index lda);

  /// out (n x n, packed with stride n, upper triangle zero) = L^-1 of a small lower triangle.
  void (*smallInverse)(Index n, const double* l, Index ldl, double* out);
};

/// The best set that this processor runs. RAVEN_CORRECTION_SIMD=portable|x86-64-v2|x86-64-v3 asks
/// for a lesser one, for tests and comparisons.
const SimdKernels& simdKernels() noexcept;

/// The set of that name, or null where it was not compiled or does not run here.
const SimdKernels* simdKernels(const char* name) noexcept;

namespace simd_portable {
const SimdKernels* kernels() noexcept;
}
namespace simd_v2 {
const SimdKernels* kernels() noexcept;
}
namespace simd_v3 {
const SimdKernels* kernels() noexcept;
}
namespace simd_v4 {
const SimdKernels* kernels() noexcept;
}

}  // namespace raven_correction
