// SPDX-License-Identifier: BSD-3-Clause
// Draws hidden causes from a seed: which joint, which sign, which shape. How large they are in tool
// space is found by running the plant: session.h and joint_session.h.
#pragma once

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

/// Finds the factor by which a cause has to be scaled so that measure(scaled cause) is `size`:
/// tries, and corrects by the ratio, until it is within 10 %.
template <typename Measure>
HiddenEffect scaledBy(const Measure& measure, const HiddenEffect& shape, double size) {
  constexpr int kMostTrials = 8;
  HiddenEffect effect = shape;
  for (int trial = 0; trial < kMostTrials; ++trial) {
    const double now = measure(effect);
    const double ratio = now > 0.0 ? size / now : 8.0;
    if (ratio > 1.0 / 1.1 && ratio < 1.1) break;
    effect = scaled(effect, ratio > 8.0 ? 8.0 : (ratio < 0.125 ? 0.125 : ratio));
  }
  return effect;
}

}  // namespace raven_correction::plant
