// SPDX-License-Identifier: BSD-3-Clause
// Inner loops for x86-64-v4 (AVX-512). CMake gives this file, and no other, -march=x86-64-v4; where
// it does not, on other processors, the set is absent.
#if defined(__AVX512F__) && defined(__AVX512DQ__)
#define RAVEN_SIMD_NAMESPACE simd_v4
#define RAVEN_SIMD_NAME "x86-64-v4"
#define RAVEN_SIMD_DOUBLES 8
#include "simd_body.h"
#else
#include "simd_kernels.h"
namespace raven_correction {
const SimdKernels* simd_v4::kernels() noexcept { return nullptr; }
}  // namespace raven_correction
#endif
