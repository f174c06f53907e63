// SPDX-License-Identifier: BSD-3-Clause
// joint_gain: the transmission ratio differs from the controller's by the share g; no error at the
// homing position.

#include "raven_correction/simulation/effect_registry.h"

namespace raven_correction {
namespace {

class JointGain final : public Effect {
 public:
  explicit JointGain(const KinematicChain& robot) {
    addJointParameters("g", robot, {"-", 0.5, "-", 0.5}, Sign::kBoth);
  }
  const char* name() const noexcept override { return "joint_gain"; }
  EffectStage stage() const noexcept override { return EffectStage::kCable; }
  const char* equation() const noexcept override { return "q = u + g (u - home)"; }
  std::unique_ptr<Effect> clone() const override { return std::make_unique<JointGain>(*this); }

  void apply(const StepContext& context, JointVector& /*memory*/,
             JointVector& q) const noexcept override {
    for (int j = 0; j < static_cast<int>(q.size()); ++j)
      q(j) += value(j) * (q(j) - context.home(j));
  }
};

}  // namespace

std::unique_ptr<Effect> makeJointGain(const KinematicChain& robot) {
  return std::make_unique<JointGain>(robot);
}

}  // namespace raven_correction
