// SPDX-License-Identifier: BSD-3-Clause
// Inner loops for x86-64-v3 (AVX2 and FMA). CMake gives this file, and no other, -march=x86-64-v3;
// where it does not, on other processors, the set is absent.
#if defined(__AVX2__) && defined(__FMA__)
#define RAVEN_SIMD_NAMESPACE simd_v3
#define RAVEN_SIMD_NAME "x86-64-v3"
#define RAVEN_SIMD_DOUBLES 4
#include "simd_body.h"
#else
#include "simd_kernels.h"
namespace raven_correction {
const SimdKernels* simd_v3::kernels() noexcept { return nullptr; }
}  // namespace raven_correction
#endif
