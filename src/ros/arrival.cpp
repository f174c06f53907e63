// SPDX-License-Identifier: BSD-3-Clause
#include "raven_correction/ros/arrival.h"

#include <cmath>
#include <limits>

#include "raven_correction/error.h"

namespace raven_correction {

Arrival::Arrival(double stamp_tolerance) : stamp_tolerance_(stamp_tolerance) {
  if (!(stamp_tolerance >= 0.0 && std::isfinite(stamp_tolerance)))
    throw InvalidInput(format("stamp_tolerance = %g, must be >= 0", stamp_tolerance));
  reset();
}

void Arrival::reset() noexcept { last_ = -std::numeric_limits<double>::infinity(); }

double Arrival::actingTime(double now, double stamp) noexcept {
  double acting = std::abs(stamp - now) <= stamp_tolerance_ ? stamp : now;
  // Later than now by more than that: the clock was set back, and the last time means nothing.
  const bool comparable = last_ <= now + stamp_tolerance_;
  if (comparable && acting < last_) acting = last_;
  last_ = acting;
  return acting;
}

}  // namespace raven_correction
