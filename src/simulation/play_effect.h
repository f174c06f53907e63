// SPDX-License-Identifier: BSD-3-Clause
// What drive_friction and backlash share: a play of full width w in every joint, and the way back
// through it. They differ in whether the encoders see it, which is their stage.
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

  bool remembers() const noexcept override { return true; }
  void apply(const StepContext& /*context*/, JointVector& memory,
             JointVector& q) const noexcept override {
    for (int j = 0; j < static_cast<int>(q.size()); ++j)
      q(j) = play(q(j), memory(j), 0.5 * value(j));
    memory = q;
  }

  /// Back through the play, q = play(u, r), r = w / 2: u is r ahead of q in the direction of
  /// motion.
  ///
  ///   u = q + (r / e) (q - play(q, e)),  e = kBelief r
  ///
  /// is that, but it takes a direction for true only after 2 e of travel, so that noise about a
  /// rest does not throw u to and fro by w; and it is the exact way back through a play that gives
  /// way, of slope e / (e + r) inside its slot. It starts in the middle, because nothing is known
  /// then. Source: Krejci, Kuhnen 2001, Inverse control of systems with hysteresis and creep,
  /// doi:10.1049/ip-cta:20010375
  void undo(const StepContext& /*context*/, JointVector& memory, JointVector& /*speed*/,
            JointVector& q) const noexcept override {
    for (int j = 0; j < static_cast<int>(q.size()); ++j) {
      memory(j) = play(q(j), memory(j), kBelief * 0.5 * value(j));
      q(j) += (q(j) - memory(j)) / kBelief;
    }
  }

 private:
  static constexpr double kBelief = 0.5;  ///< e over r [-]
};

}  // namespace raven_correction
