// SPDX-License-Identifier: BSD-3-Clause
// backlash: play of full width w between motor and joint. A reversal travels w before the joint
// follows. Encoders do not see it (unlike drive_friction).

#include "raven_correction/simulation/effect_registry.h"
#include "raven_correction/simulation/play.h"

namespace raven_correction {
namespace {

class Backlash final : public Effect {
 public:
  explicit Backlash(const KinematicChain& robot) {
    addJointParameters("w", robot, {"rad", 0.5, "m", 0.05}, Sign::kNotNegative);
  }
  const char* name() const noexcept override { return "backlash"; }
  EffectStage stage() const noexcept override { return EffectStage::kCable; }
  const char* equation() const noexcept override { return "q = play(u, w / 2)"; }
  std::unique_ptr<Effect> clone() const override { return std::make_unique<Backlash>(*this); }

  void apply(const StepContext& /*context*/, JointVector& memory,
             JointVector& q) const noexcept override {
    for (int j = 0; j < static_cast<int>(q.size()); ++j)
      q(j) = play(q(j), memory(j), 0.5 * value(j));
    memory = q;
  }
};

}  // namespace

std::unique_ptr<Effect> makeBacklash(const KinematicChain& robot) {
  return std::make_unique<Backlash>(robot);
}

}  // namespace raven_correction
