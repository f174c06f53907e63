// SPDX-License-Identifier: BSD-3-Clause
// mocap_scale: motion capture measures lengths wrong by the share s; positions are scaled about the
// origin of the base frame, orientations stay.

#include "raven_correction/simulation/effect_registry.h"

namespace raven_correction {
namespace {

class MocapScale final : public Effect {
 public:
  explicit MocapScale(const KinematicChain& /*robot*/) { addParameter("s", "-", -0.2, 0.2); }
  const char* name() const noexcept override { return "mocap_scale"; }
  EffectStage stage() const noexcept override { return EffectStage::kObservation; }
  const char* equation() const noexcept override { return "p = (1 + s) p"; }
  std::unique_ptr<Effect> clone() const override { return std::make_unique<MocapScale>(*this); }

  Pose observe(double /*time*/, const Pose& X_base_tool) const noexcept override {
    return {X_base_tool.p + value(0) * X_base_tool.p, X_base_tool.q};
  }
  Pose undoObserve(double /*time*/, const Pose& X_observed) const noexcept override {
    return {X_observed.p / (1.0 + value(0)), X_observed.q};
  }
};

}  // namespace

std::unique_ptr<Effect> makeMocapScale(const KinematicChain& robot) {
  return std::make_unique<MocapScale>(robot);
}

}  // namespace raven_correction
