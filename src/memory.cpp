// SPDX-License-Identifier: BSD-3-Clause
#include "raven_correction/memory.h"

#include <cstdlib>  // defines __GLIBC__ where it is
#if defined(__GLIBC__)
#include <malloc.h>
#endif

namespace raven_correction {

void keepFreedMemory() noexcept {
#if defined(__GLIBC__)
  constexpr int kLargest = 1 << 30;  // [bytes]
  mallopt(M_MMAP_THRESHOLD, kLargest);
  mallopt(M_TRIM_THRESHOLD, kLargest);
#endif
}

}  // namespace raven_correction
