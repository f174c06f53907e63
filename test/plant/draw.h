// SPDX-License-Identifier: BSD-3-Clause
// Draws hidden causes from a seed: which joint, which sign, which shape. How large they are in tool
// space is found by running the plant: session.h and joint_session.h.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <random>
#include <string>

#include "plant/hidden_effect.h"
#include "plant/motion.h"

namespace raven_correction::plant {

/// An effect of moderate size for this robot and this motion. Joints that cannot show it are not
/// drawn: cable_stretch where there is no load; link_geometry of the first row, which is a
/// registration of the base.
/// @throws InvalidInput  an unknown effect
HiddenEffect drawShape(const std::string& effect, const KinematicChain& robot, const Motion& motion,
                       std::mt19937_64& random);

/// A random engine that differs for each effect, too, so that one seed draws different joints.
std::mt19937_64 randomFor(const std::string& effect, std::uint64_t seed);

/// Scales a cause until measure(cause) is within 10 % of `size`, or the cause is as large as is
/// plausible. The next factor is proportional, or between those that were too small and too large.
template <typename Measure>
HiddenEffect scaledBy(const Measure& measure, const HiddenEffect& shape,
                      const KinematicChain& robot, double size) {
  constexpr int kMostTrials = 12;
  double factor = 1.0;
  double too_small = 0.0;
  double too_large = std::numeric_limits<double>::infinity();
  HiddenEffect effect = plausible(shape, robot);
  for (int trial = 0; trial < kMostTrials; ++trial) {
    const double ratio = size / std::max(measure(effect), 1e-6 * size);
    if (ratio > 1.0 / 1.1 && ratio < 1.1) break;
    (ratio > 1.0 ? too_small : too_large) = factor;
    factor *= std::clamp(ratio, 0.125, 8.0);
    if (factor <= too_small || factor >= too_large) factor = std::sqrt(too_small * too_large);
    const HiddenEffect next = plausible(scaled(shape, factor), robot);
    if (next.parameters == effect.parameters) break;  // as large as is plausible
    effect = next;
  }
  return effect;
}

}  // namespace raven_correction::plant
