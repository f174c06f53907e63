// SPDX-License-Identifier: BSD-3-Clause
// Inner loops for x86-64-v2 (SSE4.2). CMake gives this file, and no other, -march=x86-64-v2; where
// it does not, on other processors, the set is absent.
#if defined(__SSE4_2__)
#define RAVEN_SIMD_NAMESPACE simd_v2
#define RAVEN_SIMD_NAME "x86-64-v2"
#define RAVEN_SIMD_DOUBLES 2
#include "simd_body.h"
#else
#include "simd_kernels.h"
namespace raven_correction {
const SimdKernels* simd_v2::kernels() noexcept { return nullptr; }
}  // namespace raven_correction
#endif
