// SPDX-License-Identifier: BSD-3-Clause
#include "raven_correction/memory.h"

#include <cstdlib>  // defines __GLIBC__ where it is
#if defined(__GLIBC__)
#include <malloc.h>
#endif

namespace raven_correction {

void keepFreedMemory() noexcept {
#if defined(__GLIBC__)
  constexpr int kLargest = 1 << 30;      // [bytes]
  constexpr int kLargestOld = 32 << 20;  // that older versions of glibc take
  mallopt(M_ARENA_MAX, 1);  // other threads' heaps end at 64 MB and are mapped as before
  if (mallopt(M_MMAP_THRESHOLD, kLargest) == 0) mallopt(M_MMAP_THRESHOLD, kLargestOld);
  mallopt(M_TRIM_THRESHOLD, kLargest);
#endif
}

}  // namespace raven_correction
