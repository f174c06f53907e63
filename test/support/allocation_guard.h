// SPDX-License-Identifier: BSD-3-Clause
// Counts heap allocations of this thread while it lives. Include in exactly one source of a test
// program: it replaces malloc. Under a sanitizer, which owns malloc, it counts nothing.
#pragma once

#include <cerrno>
#include <cstddef>
#include <cstdlib>

// g++ says by a macro that it makes code for a sanitizer, clang by a feature.
#if defined(__has_feature)
#define RAVEN_HAS_FEATURE(feature) __has_feature(feature)
#else
#define RAVEN_HAS_FEATURE(feature) 0
#endif
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__) || \
    RAVEN_HAS_FEATURE(address_sanitizer) || RAVEN_HAS_FEATURE(thread_sanitizer)
#define RAVEN_COUNTS_ALLOCATIONS 0
#else
#define RAVEN_COUNTS_ALLOCATIONS 1
#endif

namespace raven_correction {

inline thread_local int guarded_allocations = -1;  // -1: no guard alive

class AllocationGuard {
 public:
  AllocationGuard() { guarded_allocations = 0; }
  ~AllocationGuard() { guarded_allocations = -1; }
  AllocationGuard(const AllocationGuard&) = delete;
  AllocationGuard& operator=(const AllocationGuard&) = delete;
  int count() const { return guarded_allocations; }
};

inline void noteAllocation() noexcept {
  if (guarded_allocations >= 0) ++guarded_allocations;
}

}  // namespace raven_correction

#if RAVEN_COUNTS_ALLOCATIONS
// operator new and Eigen both end in these.
extern "C" {
void* __libc_malloc(std::size_t size);
void* __libc_calloc(std::size_t count, std::size_t size);
void* __libc_realloc(void* memory, std::size_t size);
void* __libc_memalign(std::size_t alignment, std::size_t size);

void* malloc(std::size_t size) noexcept {
  raven_correction::noteAllocation();
  return __libc_malloc(size);
}
void* calloc(std::size_t count, std::size_t size) noexcept {
  raven_correction::noteAllocation();
  return __libc_calloc(count, size);
}
void* realloc(void* memory, std::size_t size) noexcept {
  raven_correction::noteAllocation();
  return __libc_realloc(memory, size);
}
void* aligned_alloc(std::size_t alignment, std::size_t size) noexcept {
  raven_correction::noteAllocation();
  return __libc_memalign(alignment, size);
}
int posix_memalign(void** memory, std::size_t alignment, std::size_t size) noexcept {
  raven_correction::noteAllocation();
  *memory = __libc_memalign(alignment, size);
  return *memory == nullptr ? ENOMEM : 0;
}
}
#endif
