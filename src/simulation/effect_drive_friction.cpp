// SPDX-License-Identifier: BSD-3-Clause
// drive_friction: Coulomb friction F_c holds a motor back from its set-point where the controller's
// proportional gain k_p cannot overcome it: it stops short by up to w/2, w = 2 F_c / k_p, against
// the motion. Encoders see it (unlike backlash).

#include "raven_correction/simulation/effect_registry.h"
#include "raven_correction/simulation/play.h"

namespace raven_correction {
namespace {

class DriveFriction final : public Effect {
 public:
  explicit DriveFriction(const KinematicChain& robot) {
    addJointParameters("w", robot, {"rad", 0.5, "m", 0.05}, Sign::kNotNegative);
  }
  const char* name() const noexcept override { return "drive_friction"; }
  EffectStage stage() const noexcept override { return EffectStage::kDrive; }
  const char* equation() const noexcept override { return "q = play(u, w / 2)"; }
  std::unique_ptr<Effect> clone() const override { return std::make_unique<DriveFriction>(*this); }

  void apply(const StepContext& /*context*/, JointVector& memory,
             JointVector& q) const noexcept override {
    for (int j = 0; j < static_cast<int>(q.size()); ++j)
      q(j) = play(q(j), memory(j), 0.5 * value(j));
    memory = q;
  }
};

}  // namespace

std::unique_ptr<Effect> makeDriveFriction(const KinematicChain& robot) {
  return std::make_unique<DriveFriction>(robot);
}

}  // namespace raven_correction
