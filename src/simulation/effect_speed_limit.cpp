// SPDX-License-Identifier: BSD-3-Clause
// speed_limit: a joint moves towards its set-point no faster than v. v = 0 stands for no limit, so
// that the nominal value 0 changes nothing.

#include <algorithm>

#include "raven_correction/simulation/effect_registry.h"

namespace raven_correction {
namespace {

class SpeedLimit final : public Effect {
 public:
  explicit SpeedLimit(const KinematicChain& robot) {
    addJointParameters("v", robot, {"rad/s", 20.0, "m/s", 2.0}, Sign::kNotNegative);
  }
  const char* name() const noexcept override { return "speed_limit"; }
  EffectStage stage() const noexcept override { return EffectStage::kDrive; }
  const char* equation() const noexcept override { return "|dq/dt| <= v"; }
  std::unique_ptr<Effect> clone() const override { return std::make_unique<SpeedLimit>(*this); }

  bool remembers() const noexcept override { return true; }
  void apply(const StepContext& context, JointVector& memory,
             JointVector& q) const noexcept override {
    for (int j = 0; j < static_cast<int>(q.size()); ++j) {
      const double reach = value(j) * context.step;
      if (value(j) > 0.0) q(j) = std::min(memory(j) + reach, std::max(memory(j) - reach, q(j)));
    }
    memory = q;
  }
  /// A joint at its limit does not tell how far its set-point is ahead: taken to be where the joint
  /// is.
  void undo(const StepContext& /*context*/, JointVector& /*memory*/, JointVector& /*speed*/,
            JointVector& /*q*/) const noexcept override {}
};

}  // namespace

std::unique_ptr<Effect> makeSpeedLimit(const KinematicChain& robot) {
  return std::make_unique<SpeedLimit>(robot);
}

}  // namespace raven_correction
