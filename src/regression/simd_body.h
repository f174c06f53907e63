// SPDX-License-Identifier: BSD-3-Clause
// Body of simd_kernels_*.cpp, which define RAVEN_SIMD_NAMESPACE, RAVEN_SIMD_NAME and
// RAVEN_SIMD_DOUBLES (lanes). It includes nothing that has inline functions: the linker might keep
// a copy that was compiled for another processor.
#include <cstddef>

#include "simd_kernels.h"
#if defined(__SSE2__)
#include <immintrin.h>
#endif

namespace raven_correction {
namespace RAVEN_SIMD_NAMESPACE {
namespace {

using Index = SimdKernels::Index;
constexpr int kLanes = RAVEN_SIMD_DOUBLES;
typedef double Vec __attribute__((vector_size(8 * kLanes)));
typedef double LooseVec __attribute__((vector_size(8 * kLanes), aligned(8), may_alias));
typedef long long Bits __attribute__((vector_size(8 * kLanes)));

inline Vec load(const double* p) { return *reinterpret_cast<const LooseVec*>(p); }
inline void store(double* p, Vec v) { *reinterpret_cast<LooseVec*>(p) = v; }
inline Vec all(double x) { return x - Vec{}; }

inline Vec squareRoot(Vec x) {
#if RAVEN_SIMD_DOUBLES == 8
  return reinterpret_cast<Vec>(_mm512_maskz_sqrt_pd(0xff, reinterpret_cast<__m512d>(x)));
#elif RAVEN_SIMD_DOUBLES == 4
  return reinterpret_cast<Vec>(_mm256_sqrt_pd(reinterpret_cast<__m256d>(x)));
#elif defined(__SSE2__)
  return reinterpret_cast<Vec>(_mm_sqrt_pd(reinterpret_cast<__m128d>(x)));
#else
  for (int i = 0; i < kLanes; ++i) x[i] = __builtin_sqrt(x[i]);
  return x;
#endif
}

// exp(x) for x <= 0, to one unit in the last place: x = n ln 2 + r, |r| <= ln(2)/2, a Taylor
// polynomial of degree 12 for exp(r) (the next term is below 2e-16), and n put into the exponent.
// Below -708, where the result would be subnormal, it is zero. NaN stays NaN.
inline Vec exponential(Vec x) {
  constexpr double kShift = 6755399441055744.0;  // 1.5 * 2^52: adding it rounds to an integer
  const Vec zero = {};
  const auto tiny = x < all(-708.0);
  x = tiny ? zero : x;
  const Vec shifted = x * 1.4426950408889634 + kShift;
  const Vec n = shifted - kShift;
  const Vec r = (x - n * 0.693147180369123816490) - n * 1.90821492927058770002e-10;
  const Vec r2 = r * r;
  const Vec r4 = r2 * r2;
  const Vec p01 = r + 1.0;
  const Vec p23 = r * (1.0 / 6.0) + 0.5;
  const Vec p45 = r * (1.0 / 120.0) + 1.0 / 24.0;
  const Vec p67 = r * (1.0 / 5040.0) + 1.0 / 720.0;
  const Vec p89 = r * (1.0 / 362880.0) + 1.0 / 40320.0;
  const Vec pab = r * (1.0 / 39916800.0) + 1.0 / 3628800.0;
  const Vec low = p01 + r2 * p23;
  const Vec middle = p45 + r2 * p67;
  const Vec high = (p89 + r2 * pab) + r4 * (1.0 / 479001600.0);
  const Vec polynomial = low + r4 * (middle + r4 * high);
  const Bits exponent = (reinterpret_cast<Bits>(shifted) + 1023) << 52;
  return tiny ? zero : polynomial * reinterpret_cast<Vec>(exponent);
}

template <int kRowVectors, int kColumns>
inline void tileOf(Index k, double alpha, const double* a, const double* b, double* c, Index ldc) {
  Vec sum[kColumns][kRowVectors] = {};
  for (Index p = 0; p < k; ++p) {
    Vec row[kRowVectors];
#pragma GCC unroll 4
    for (int i = 0; i < kRowVectors; ++i) row[i] = load(a + i * kLanes);
#pragma GCC unroll 8
    for (int j = 0; j < kColumns; ++j) {
      const double value = b[j];
#pragma GCC unroll 4
      for (int i = 0; i < kRowVectors; ++i) sum[j][i] += row[i] * value;
    }
    a += kRowVectors * kLanes;
    b += kColumns;
  }
#pragma GCC unroll 8
  for (int j = 0; j < kColumns; ++j)
#pragma GCC unroll 4
    for (int i = 0; i < kRowVectors; ++i)
      store(c + i * kLanes + j * ldc, load(c + i * kLanes + j * ldc) + alpha * sum[j][i]);
}

// 32, 16 and 16 registers hold the tile, one column of A and one value of B.
constexpr int kTileRowVectors = kLanes == 8 ? 3 : (kLanes == 4 ? 3 : 2);
constexpr int kTileColumns = kLanes == 8 ? 8 : 4;

void tile(Index k, double alpha, const double* a, const double* b, double* c, Index ldc) {
  tileOf<kTileRowVectors, kTileColumns>(k, alpha, a, b, c, ldc);
}

// Correlation and slope of kernel.h from a squared distance.
template <int kKernel, bool kSlope>
inline Vec correlate(Vec squared, Vec& slope) {
  if constexpr (kKernel == 0) {
    const Vec e = exponential(-0.5 * squared);
    slope = e;
    return e;
  } else if constexpr (kKernel == 1) {
    const Vec t = squareRoot(3.0 * squared);
    const Vec e = exponential(-t);
    if constexpr (kSlope) slope = 3.0 * e;
    return (t + 1.0) * e;
  } else {
    const Vec t = squareRoot(5.0 * squared);
    const Vec e = exponential(-t);
    if constexpr (kSlope) slope = (5.0 / 3.0) * (t + 1.0) * e;
    return (t + 1.0 + t * t * (1.0 / 3.0)) * e;
  }
}

inline void storeFirst(double* to, Vec v, Index count) {
  for (Index i = 0; i < count; ++i) to[i] = v[i];
}

// Blocks of kVectors vectors of points a against kColumns points b.
template <int kKernel, bool kSlope, int kVectors, int kColumns>
inline void correlationBlock(Index d, Index count, const double* a, Index lda, const double* b,
                             Index ldb, double* c, double* slopes, Index ldc) {
  Vec squared[kColumns][kVectors] = {};
  for (Index f = 0; f < d; ++f) {
    Vec point[kVectors];
    for (int v = 0; v < kVectors; ++v) point[v] = load(a + f * lda + v * kLanes);
    for (int j = 0; j < kColumns; ++j) {
      const double other = b[f + j * ldb];
      for (int v = 0; v < kVectors; ++v) {
        const Vec difference = point[v] - other;
        squared[j][v] += difference * difference;
      }
    }
  }
  for (int j = 0; j < kColumns; ++j)
    for (int v = 0; v < kVectors; ++v) {
      Vec slope = {};
      const Vec value = correlate<kKernel, kSlope>(squared[j][v], slope);
      const Index left = count - v * kLanes;
      double* const to = c + v * kLanes + j * ldc;
      if (left >= kLanes) {
        store(to, value);
        if constexpr (kSlope) store(slopes + v * kLanes + j * ldc, slope);
      } else if (left > 0) {
        storeFirst(to, value, left);
        if constexpr (kSlope) storeFirst(slopes + v * kLanes + j * ldc, slope, left);
      }
    }
}

template <int kKernel, bool kSlope>
void correlationsOf(Index d, Index n, const double* a, Index lda, Index m, const double* b,
                    Index ldb, double* c, double* slopes, Index ldc) {
  constexpr int kVectors = 2;
  for (Index i = 0; i < n; i += kVectors * kLanes) {
    double* const g = kSlope ? slopes + i : nullptr;
    Index j = 0;
    for (; j + 4 <= m; j += 4)
      correlationBlock<kKernel, kSlope, kVectors, 4>(
          d, n - i, a + i, lda, b + j * ldb, ldb, c + i + j * ldc, kSlope ? g + j * ldc : g, ldc);
    for (; j < m; ++j)
      correlationBlock<kKernel, kSlope, kVectors, 1>(
          d, n - i, a + i, lda, b + j * ldb, ldb, c + i + j * ldc, kSlope ? g + j * ldc : g, ldc);
  }
}

void correlations(int kernel, Index d, Index n, const double* a, Index lda, Index m,
                  const double* b, Index ldb, double* c, double* slopes, Index ldc) {
  if (d == 0) a = c;  // points without features have no memory; none of it is read
  if (slopes == nullptr) {
    if (kernel == 0) correlationsOf<0, false>(d, n, a, lda, m, b, ldb, c, slopes, ldc);
    if (kernel == 1) correlationsOf<1, false>(d, n, a, lda, m, b, ldb, c, slopes, ldc);
    if (kernel == 2) correlationsOf<2, false>(d, n, a, lda, m, b, ldb, c, slopes, ldc);
  } else {
    if (kernel == 0) correlationsOf<0, true>(d, n, a, lda, m, b, ldb, c, slopes, ldc);
    if (kernel == 1) correlationsOf<1, true>(d, n, a, lda, m, b, ldb, c, slopes, ldc);
    if (kernel == 2) correlationsOf<2, true>(d, n, a, lda, m, b, ldb, c, slopes, ldc);
  }
}

// kColumns columns of A against kSides columns of B.
template <int kColumns, int kSides>
inline void subtractTransposedBlock(Index rows, const double* a, Index lda, const double* b,
                                    Index ldb, double* c, Index ldc) {
  Vec sum[kColumns][kSides] = {};
  Index i = 0;
  for (; i + kLanes <= rows; i += kLanes) {
    Vec side[kSides];
    for (int k = 0; k < kSides; ++k) side[k] = load(b + i + k * ldb);
    for (int j = 0; j < kColumns; ++j) {
      const Vec value = load(a + i + j * lda);
      for (int k = 0; k < kSides; ++k) sum[j][k] += value * side[k];
    }
  }
  for (int j = 0; j < kColumns; ++j)
    for (int k = 0; k < kSides; ++k) {
      double total = 0.0;
      for (int lane = 0; lane < kLanes; ++lane) total += sum[j][k][lane];
      for (Index r = i; r < rows; ++r) total += a[r + j * lda] * b[r + k * ldb];
      c[j + k * ldc] -= total;
    }
}

template <int kColumns>
inline void subtractTransposedColumns(Index rows, Index q, const double* a, Index lda,
                                      const double* b, Index ldb, double* c, Index ldc) {
  Index k = 0;
  for (; k + 3 <= q; k += 3)
    subtractTransposedBlock<kColumns, 3>(rows, a, lda, b + k * ldb, ldb, c + k * ldc, ldc);
  for (; k < q; ++k)
    subtractTransposedBlock<kColumns, 1>(rows, a, lda, b + k * ldb, ldb, c + k * ldc, ldc);
}

void subtractTransposed(Index rows, Index columns, Index q, const double* a, Index lda,
                        const double* b, Index ldb, double* c, Index ldc) {
  Index j = 0;
  for (; j + 4 <= columns; j += 4)
    subtractTransposedColumns<4>(rows, q, a + j * lda, lda, b, ldb, c + j, ldc);
  for (; j < columns; ++j)
    subtractTransposedColumns<1>(rows, q, a + j * lda, lda, b, ldb, c + j, ldc);
}

constexpr int kPanelVectors = 4;
constexpr Index kPanelRows = kPanelVectors * kLanes;

double squaredNormLower(Index n, const double* panels, const double* x) {
  Vec total = {};
  for (Index first = 0; first < n; first += kPanelRows) {
    Vec even[kPanelVectors] = {};
    Vec odd[kPanelVectors] = {};
    for (Index p = 0; p < first + kPanelRows; p += 2) {
      for (int v = 0; v < kPanelVectors; ++v) even[v] += load(panels + v * kLanes) * x[p];
      panels += kPanelRows;
      for (int v = 0; v < kPanelVectors; ++v) odd[v] += load(panels + v * kLanes) * x[p + 1];
      panels += kPanelRows;
    }
    for (int v = 0; v < kPanelVectors; ++v) {
      const Vec y = even[v] + odd[v];
      total += y * y;
    }
  }
  double sum = 0.0;
  for (int i = 0; i < kLanes; ++i) sum += total[i];
  return sum;
}

// y -= value * x over count values.
inline void subtractMultiple(Index count, double value, const double* x, double* y) {
  Index i = 0;
  for (; i + kLanes <= count; i += kLanes) store(y + i, load(y + i) - value * load(x + i));
  for (; i < count; ++i) y[i] -= value * x[i];
}

Index smallCholesky(Index n, double* a, Index lda) {
  for (Index j = 0; j < n; ++j) {
    double* const column = a + j * lda;
    for (Index k = 0; k < j; ++k)
      subtractMultiple(n - j, a[j + k * lda], a + j + k * lda, column + j);
    if (!(column[j] > 0.0)) return j + 1;
    const double pivot = __builtin_sqrt(column[j]);
    const double inverse = 1.0 / pivot;
    column[j] = pivot;
    for (Index i = j + 1; i < n; ++i) column[i] *= inverse;
  }
  return 0;
}

void smallInverse(Index n, const double* l, Index ldl, double* out) {
  for (Index j = 0; j < n; ++j) {
    double* const column = out + j * n;
    for (Index i = 0; i < n; ++i) column[i] = i == j ? 1.0 : 0.0;
    for (Index k = j; k < n; ++k) {
      column[k] /= l[k + k * ldl];
      subtractMultiple(n - k - 1, column[k], l + k + 1 + k * ldl, column + k + 1);
    }
  }
}

constexpr SimdKernels kTable = {
    RAVEN_SIMD_NAME, kTileRowVectors* kLanes, kTileColumns,     kPanelRows,    tile,
    correlations,    subtractTransposed,      squaredNormLower, smallCholesky, smallInverse};

}  // namespace

const SimdKernels* kernels() noexcept { return &kTable; }

}  // namespace RAVEN_SIMD_NAMESPACE
}  // namespace raven_correction
