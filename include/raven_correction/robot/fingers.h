// SPDX-License-Identifier: BSD-3-Clause
// Two finger joints against the wrist yaw and jaw opening that they make. A pose holds only the
// yaw; the opening is carried along beside it.
#pragma once

#include <cmath>

namespace raven_correction {

///   yaw = (g2 - g1) / 2,   opening = g1 + g2        (all in rad)
struct Fingers {
  double g1 = 0.0;
  double g2 = 0.0;

  static Fingers from(double yaw, double opening) noexcept {
    return {0.5 * opening - yaw, 0.5 * opening + yaw};
  }
  double yaw() const noexcept { return 0.5 * (g2 - g1); }
  double opening() const noexcept { return g1 + g2; }
};

/// Largest |yaw| that keeps both fingers within +-limit at this opening [rad]; 0 if none does.
inline double largestYaw(double opening, double limit) noexcept {
  return std::fmax(0.0, limit - 0.5 * std::abs(opening));
}

}  // namespace raven_correction
