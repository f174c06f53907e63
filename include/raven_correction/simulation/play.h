// SPDX-License-Identifier: BSD-3-Clause
// The play operator: what remains behind when motion is passed on through a slot.
#pragma once

#include <algorithm>

namespace raven_correction {

/// A pin in a slot of half-width r, exact for any sequence of monotone inputs between samples.
///
///   x_k = min(u_k + r, max(u_k - r, x_{k-1}))
///
/// u: driving side; x: driven side, same units. Driven towards +u the output lags, x = u - r;
/// towards -u, x = u + r; a reversal travels 2 r before the output follows. r >= 0; r = 0 gives u.
/// Source: Brokate, Sprekels 1996, Hysteresis and Phase Transitions, doi:10.1007/978-1-4612-4048-8
inline double play(double u, double x_previous, double r) noexcept {
  return std::min(u + r, std::max(u - r, x_previous));
}

}  // namespace raven_correction
