// SPDX-License-Identifier: BSD-3-Clause
// registration_shift: base or cameras were bumped at t0 [s since the start of the session]; from
// then on everything is seen displaced by x, y, z and rx, ry, rz in `base`.

#include "raven_correction/simulation/effect_registry.h"

namespace raven_correction {
namespace {

class RegistrationShift final : public Effect {
 public:
  explicit RegistrationShift(const KinematicChain& /*robot*/) {
    addParameter("t0", "s", 0.0, 1e6);
    addPoseParameters(0.2, 1.5);
  }
  const char* name() const noexcept override { return "registration_shift"; }
  EffectStage stage() const noexcept override { return EffectStage::kObservation; }
  const char* equation() const noexcept override {
    return "X_observed = X_err X_base_tool after t0";
  }
  std::unique_ptr<Effect> clone() const override {
    return std::make_unique<RegistrationShift>(*this);
  }

  Pose observe(double time, const Pose& X_base_tool) const noexcept override {
    return time >= value(0) ? poseValue(1) * X_base_tool : X_base_tool;
  }
  Pose undoObserve(double time, const Pose& X_observed) const noexcept override {
    return time >= value(0) ? poseValue(1).inverse() * X_observed : X_observed;
  }
};

}  // namespace

std::unique_ptr<Effect> makeRegistrationShift(const KinematicChain& robot) {
  return std::make_unique<RegistrationShift>(robot);
}

}  // namespace raven_correction
