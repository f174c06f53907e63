// SPDX-License-Identifier: BSD-3-Clause
// What drive_friction and backlash share: a play of full width w in every joint. They differ in
// whether the encoders see it, which is their stage.
#pragma once

#include "raven_correction/simulation/effect_registry.h"
#include "raven_correction/simulation/play.h"

namespace raven_correction {

class PlayEffect : public Effect {
 public:
  explicit PlayEffect(const KinematicChain& robot) {
    addJointParameters("w", robot, {"rad", 0.5, "m", 0.05}, Sign::kNotNegative);
  }
  const char* equation() const noexcept override { return "q = play(u, w / 2)"; }

  void apply(const StepContext& /*context*/, JointVector& memory,
             JointVector& q) const noexcept override {
    for (int j = 0; j < static_cast<int>(q.size()); ++j)
      q(j) = play(q(j), memory(j), 0.5 * value(j));
    memory = q;
  }
};

}  // namespace raven_correction
