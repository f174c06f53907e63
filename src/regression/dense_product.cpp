// SPDX-License-Identifier: BSD-3-Clause
// Matrix products: packed blocks that fit the caches, spread over threads, around one register
// tile. Source of the blocking: Goto, van de Geijn 2008, Anatomy of high-performance matrix
// multiplication, doi:10.1145/1356052.1356053
#include <omp.h>

#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <new>

#include "raven_correction/regression/dense.h"
#include "simd_kernels.h"

namespace raven_correction {
namespace {

constexpr DenseIndex kDepth = 256;            // k of one block: a B tile of it stays in L1
constexpr DenseIndex kTilesPerBlock = 4;      // rows of one A block, in tiles: it stays in L2
constexpr DenseIndex kColumns = 2048;         // columns of one B block: it stays in L3
constexpr double kWorkForThreads = 2e7;       // multiply-adds below which one thread is faster
constexpr double kPacking = 16.0;             // multiply-adds that packing one value is worth
constexpr DenseIndex kLargestTile = 32 * 16;  // values of one tile, any instruction set

// Memory that a thread keeps between products; page faults cost more than small products.
class Scratch {
 public:
  double* atLeast(DenseIndex count) {
    if (count > size_) {
      memory_.reset(static_cast<double*>(
          std::aligned_alloc(64, (std::size_t(count) * sizeof(double) + 63) / 64 * 64)));
      if (memory_ == nullptr) throw std::bad_alloc();
      size_ = count;
    }
    return memory_.get();
  }

 private:
  struct Free {
    void operator()(double* memory) const { std::free(memory); }
  };
  std::unique_ptr<double, Free> memory_;
  DenseIndex size_ = 0;
};

DenseIndex roundUp(DenseIndex value, DenseIndex to) { return (value + to - 1) / to * to; }

// `width` rows of op(A) (or columns of B), k steps deep, as k groups of `width` values. Rows past
// `valid` are zero. stride_row, stride_step: distance of neighbours in memory; one of them is 1.
void pack(DenseIndex width, DenseIndex valid, DenseIndex k, const double* from,
          DenseIndex stride_row, DenseIndex stride_step, double* to) {
  if (valid < width) std::memset(to, 0, std::size_t(width * k) * sizeof(double));
  if (stride_row == 1) {
    for (DenseIndex p = 0; p < k; ++p)
      for (DenseIndex i = 0; i < valid; ++i) to[i + p * width] = from[i + p * stride_step];
    return;
  }
  constexpr DenseIndex kChunk = 8;  // steps at a time, so that a cache line is read once
  DenseIndex p = 0;
  for (; p + kChunk <= k; p += kChunk)
    for (DenseIndex i = 0; i < valid; ++i) {
      const double* const source = from + i * stride_row + p * stride_step;
      for (DenseIndex s = 0; s < kChunk; ++s) to[i + (p + s) * width] = source[s * stride_step];
    }
  for (; p < k; ++p)
    for (DenseIndex i = 0; i < valid; ++i)
      to[i + p * width] = from[i * stride_row + p * stride_step];
}

// Whole tiles of rows next to one another in memory, k steps deep, a column at a time.
void packTiles(DenseIndex width, DenseIndex rows, DenseIndex k, const double* from,
               DenseIndex stride_step, double* to) {
  for (DenseIndex p = 0; p < k; ++p)
    for (DenseIndex i = 0; i < rows; i += width)
      std::memcpy(to + i * k + p * width, from + i + p * stride_step,
                  std::size_t(width) * sizeof(double));
}

struct Product {
  DenseIndex m, n, k;
  double alpha;
  const double* a;  // op(A)(i, p) = a[i * a_row + p * a_step]
  DenseIndex a_row, a_step;
  const double* b;  // op(B)(p, j) = b[j * b_row + p * b_step]
  DenseIndex b_row, b_step;
  double* c;
  DenseIndex ldc;
  bool lower;  // only the lower triangle of C
};

// One packed A block (rows first_row ... first_row + rows) times one packed B block.
void multiplyBlock(const SimdKernels& simd, const Product& product, DenseIndex first_row,
                   DenseIndex rows, DenseIndex first_column, DenseIndex columns, DenseIndex depth,
                   const double* packed_a, const double* packed_b) {
  const DenseIndex mr = simd.tile_rows;
  const DenseIndex nr = simd.tile_columns;
  alignas(64) double edge[kLargestTile];
  for (DenseIndex j = 0; j < columns; j += nr) {
    for (DenseIndex i = 0; i < rows; i += mr) {
      const DenseIndex row = first_row + i;
      const DenseIndex column = first_column + j;
      if (product.lower && row + mr <= column) continue;
      const double* const tile_a = packed_a + i * depth;
      const double* const tile_b = packed_b + j * depth;
      double* const c = product.c + row + column * product.ldc;
      const bool whole = i + mr <= rows && j + nr <= columns;
      if (whole && (!product.lower || row >= column + nr - 1)) {
        simd.tile(depth, product.alpha, tile_a, tile_b, c, product.ldc);
        continue;
      }
      std::fill(edge, edge + mr * nr, 0.0);
      simd.tile(depth, product.alpha, tile_a, tile_b, edge, mr);
      const DenseIndex width = std::min(nr, columns - j);
      const DenseIndex height = std::min(mr, rows - i);
      for (DenseIndex s = 0; s < width; ++s) {
        const DenseIndex top =
            product.lower ? std::max<DenseIndex>(0, column + s - row) : DenseIndex(0);
        for (DenseIndex r = top; r < height; ++r) c[r + s * product.ldc] += edge[r + s * mr];
      }
    }
  }
}

void addProduct(const Product& product) {
  static thread_local Scratch scratch_b;
  const SimdKernels& simd = simdKernels();
  const DenseIndex mr = simd.tile_rows;
  const DenseIndex nr = simd.tile_columns;
  const DenseIndex block_rows = kTilesPerBlock * mr;
  const double work =
      (double(product.m) * double(product.n) + kPacking * (double(product.m) + double(product.n))) *
      double(product.k);
  const int threads = work < kWorkForThreads || omp_in_parallel() ? 1 : omp_get_max_threads();
  const DenseIndex depth_largest = std::min(kDepth, product.k);
  double* const packed_b =
      scratch_b.atLeast(depth_largest * roundUp(std::min(kColumns, product.n), nr));
  const DenseIndex blocks = (product.m + block_rows - 1) / block_rows;

#pragma omp parallel num_threads(threads) if (threads > 1)
  {
    static thread_local Scratch scratch_a;
    double* const packed_a = scratch_a.atLeast(depth_largest * block_rows);
    for (DenseIndex column = 0; column < product.n; column += kColumns) {
      const DenseIndex columns = std::min(kColumns, product.n - column);
      for (DenseIndex step = 0; step < product.k; step += kDepth) {
        const DenseIndex depth = std::min(kDepth, product.k - step);
#pragma omp for schedule(dynamic, 8)
        for (DenseIndex j = 0; j < columns; j += nr)
          pack(nr, std::min(nr, columns - j), depth,
               product.b + (column + j) * product.b_row + step * product.b_step, product.b_row,
               product.b_step, packed_b + j * depth);
          // Rows from the last: with a lower triangle they hold the most work.
#pragma omp for schedule(dynamic, 1)
        for (DenseIndex block = 0; block < blocks; ++block) {
          const DenseIndex row = (blocks - 1 - block) * block_rows;
          const DenseIndex rows = std::min(block_rows, product.m - row);
          if (product.lower && row + rows <= column) continue;
          const bool whole = product.a_row == 1 && rows % mr == 0;
          if (whole)
            packTiles(mr, rows, depth, product.a + row + step * product.a_step, product.a_step,
                      packed_a);
          for (DenseIndex i = 0; i < rows && !whole; i += mr)
            pack(mr, std::min(mr, rows - i), depth,
                 product.a + (row + i) * product.a_row + step * product.a_step, product.a_row,
                 product.a_step, packed_a + i * depth);
          multiplyBlock(simd, product, row, rows, column, columns, depth, packed_a, packed_b);
        }
      }
    }
  }
}

void scale(DenseIndex m, DenseIndex n, double beta, bool lower, double* c, DenseIndex ldc) {
  if (beta == 1.0) return;
  for (DenseIndex j = 0; j < n; ++j) {
    double* const column = c + j * ldc;
    const DenseIndex top = lower ? j : 0;
    if (beta == 0.0)
      std::fill(column + std::min(top, m), column + m, 0.0);
    else
      for (DenseIndex i = top; i < m; ++i) column[i] *= beta;
  }
}

}  // namespace

void multiply(Transpose transpose_a, Transpose transpose_b, DenseIndex m, DenseIndex n,
              DenseIndex k, double alpha, const double* a, DenseIndex lda, const double* b,
              DenseIndex ldb, double beta, double* c, DenseIndex ldc) {
  scale(m, n, beta, false, c, ldc);
  if (m == 0 || n == 0 || k == 0) return;
  const bool ta = transpose_a == Transpose::kYes;
  const bool tb = transpose_b == Transpose::kYes;
  addProduct({m, n, k, alpha, a, ta ? lda : 1, ta ? 1 : lda, b, tb ? 1 : ldb, tb ? ldb : 1, c, ldc,
              false});
}

void multiplySymmetric(Transpose transpose, DenseIndex n, DenseIndex k, double alpha,
                       const double* a, DenseIndex lda, double beta, double* c, DenseIndex ldc) {
  scale(n, n, beta, true, c, ldc);
  if (n == 0 || k == 0) return;
  const bool t = transpose == Transpose::kYes;
  const DenseIndex row = t ? lda : 1;
  const DenseIndex step = t ? 1 : lda;
  addProduct({n, n, k, alpha, a, row, step, a, row, step, c, ldc, true});
}

}  // namespace raven_correction
