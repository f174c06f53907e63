// SPDX-License-Identifier: BSD-3-Clause
// base_registration: the robot's base is not where the registration says. x, y, z and the rotation
// vector rx, ry, rz are the pose of the real robot base in the frame `base` of the registration.

#include "raven_correction/simulation/effect_registry.h"

namespace raven_correction {
namespace {

class BaseRegistration final : public Effect {
 public:
  explicit BaseRegistration(const KinematicChain& /*robot*/) { addPoseParameters(0.2, 1.5); }
  const char* name() const noexcept override { return "base_registration"; }
  EffectStage stage() const noexcept override { return EffectStage::kKinematics; }
  const char* equation() const noexcept override { return "X_observed = X_err X_base_tool"; }
  std::unique_ptr<Effect> clone() const override {
    return std::make_unique<BaseRegistration>(*this);
  }

  Pose base() const noexcept override { return poseValue(0); }
};

}  // namespace

std::unique_ptr<Effect> makeBaseRegistration(const KinematicChain& robot) {
  return std::make_unique<BaseRegistration>(robot);
}

}  // namespace raven_correction
