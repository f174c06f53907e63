// SPDX-License-Identifier: BSD-3-Clause
// Inner loops for whatever processor the compiler aims at by default.
#define RAVEN_SIMD_NAMESPACE simd_portable
#define RAVEN_SIMD_NAME "portable"
#define RAVEN_SIMD_DOUBLES 2
#include "simd_body.h"
