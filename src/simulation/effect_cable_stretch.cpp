// SPDX-License-Identifier: BSD-3-Clause
// cable_stretch: a joint gives way by s times its load (gravity of the links and the payload), in
// the direction in which the load pulls.

#include "raven_correction/simulation/effect_registry.h"

namespace raven_correction {
namespace {

class CableStretch final : public Effect {
 public:
  explicit CableStretch(const KinematicChain& robot) {
    addJointParameters("s", robot, {"rad/Nm", 1.0, "m/N", 0.05}, Sign::kNotNegative);
  }
  const char* name() const noexcept override { return "cable_stretch"; }
  EffectStage stage() const noexcept override { return EffectStage::kCable; }
  const char* equation() const noexcept override { return "q = u + s load"; }
  std::unique_ptr<Effect> clone() const override { return std::make_unique<CableStretch>(*this); }

  bool needsLoad() const noexcept override { return true; }
  void apply(const StepContext& context, JointVector& /*memory*/,
             JointVector& q) const noexcept override {
    for (int j = 0; j < static_cast<int>(q.size()); ++j) q(j) += value(j) * context.load(j);
  }
};

}  // namespace

std::unique_ptr<Effect> makeCableStretch(const KinematicChain& robot) {
  return std::make_unique<CableStretch>(robot);
}

}  // namespace raven_correction
