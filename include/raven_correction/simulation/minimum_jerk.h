// SPDX-License-Identifier: BSD-3-Clause
// The smooth profile of all commanded motions.
#pragma once

#include <algorithm>

namespace raven_correction {

/// 0 to 1 for s in [0, 1], at rest and without acceleration at both ends; 0 before, 1 after. Its
/// largest slope is 1.875, its largest curvature 10 / sqrt(3).
/// Source: Flash, Hogan 1985, doi:10.1523/JNEUROSCI.05-07-01688.1985
inline double minimumJerk(double s) noexcept {
  s = std::clamp(s, 0.0, 1.0);
  return s * s * s * (10.0 + s * (-15.0 + 6.0 * s));
}

}  // namespace raven_correction
