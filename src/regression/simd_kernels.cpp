// SPDX-License-Identifier: BSD-3-Clause
// Which compiled set of inner loops this processor gets.
#include "simd_kernels.h"

#include <cstdlib>
#include <cstring>

namespace raven_correction {
namespace {

// Sets that were compiled and run here, best first; the portable one is last and always there.
struct Available {
  const SimdKernels* sets[4] = {};
  int count = 0;

  void add(bool supported, const SimdKernels* set) {
    if (supported && set != nullptr) sets[count++] = set;
  }
  Available() {
#if defined(__x86_64__)
    __builtin_cpu_init();
    const bool v2 = __builtin_cpu_supports("sse4.2") && __builtin_cpu_supports("popcnt");
    const bool v3 = v2 && __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma") &&
                    __builtin_cpu_supports("bmi") && __builtin_cpu_supports("bmi2");
    const bool v4 = v3 && __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
                    __builtin_cpu_supports("avx512bw") && __builtin_cpu_supports("avx512vl") &&
                    __builtin_cpu_supports("avx512cd");
    add(v4, simd_v4::kernels());
    add(v3, simd_v3::kernels());
    add(v2, simd_v2::kernels());
#endif
    add(true, simd_portable::kernels());
  }
};

const Available& available() noexcept {
  static const Available sets;
  return sets;
}

}  // namespace

const SimdKernels* simdKernels(const char* name) noexcept {
  for (int i = 0; i < available().count; ++i)
    if (std::strcmp(available().sets[i]->name, name) == 0) return available().sets[i];
  return nullptr;
}

const SimdKernels& simdKernels() noexcept {
  static const SimdKernels& chosen = [&]() -> const SimdKernels& {
    const char* const wanted = std::getenv("RAVEN_CORRECTION_SIMD");
    const SimdKernels* const set = wanted != nullptr ? simdKernels(wanted) : nullptr;
    return set != nullptr ? *set : *available().sets[0];
  }();
  return chosen;
}

}  // namespace raven_correction
