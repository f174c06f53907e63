// SPDX-License-Identifier: BSD-3-Clause
// joint_offset: the joint was homed d away from where the controller believes it to be.

#include "raven_correction/simulation/effect_registry.h"

namespace raven_correction {
namespace {

class JointOffset final : public Effect {
 public:
  explicit JointOffset(const KinematicChain& robot) {
    addJointParameters("d", robot, {"rad", 1.0, "m", 0.1}, Sign::kBoth);
  }
  const char* name() const noexcept override { return "joint_offset"; }
  EffectStage stage() const noexcept override { return EffectStage::kCable; }
  const char* equation() const noexcept override { return "q = u + d"; }
  std::unique_ptr<Effect> clone() const override { return std::make_unique<JointOffset>(*this); }

  void apply(const StepContext& /*context*/, JointVector& /*memory*/,
             JointVector& q) const noexcept override {
    for (int j = 0; j < static_cast<int>(q.size()); ++j) q(j) += value(j);
  }
};

}  // namespace

std::unique_ptr<Effect> makeJointOffset(const KinematicChain& robot) {
  return std::make_unique<JointOffset>(robot);
}

}  // namespace raven_correction
