// SPDX-License-Identifier: BSD-3-Clause
// creep: cables settle, and a joint drifts by a over the session with time constant T, from nothing
// at its start. T = 0 has all of it from the start.

#include <cmath>

#include "raven_correction/simulation/effect_registry.h"

namespace raven_correction {
namespace {

class Creep final : public Effect {
 public:
  explicit Creep(const KinematicChain& robot) {
    addJointParameters("a", robot, {"rad", 0.5, "m", 0.05}, Sign::kBoth);
    addJointParameters("T", robot, {"s", 1e5, "s", 1e5}, Sign::kNotNegative);
  }
  const char* name() const noexcept override { return "creep"; }
  EffectStage stage() const noexcept override { return EffectStage::kCable; }
  const char* equation() const noexcept override { return "q = u + a (1 - exp(-t / T))"; }
  std::unique_ptr<Effect> clone() const override { return std::make_unique<Creep>(*this); }

  void apply(const StepContext& context, JointVector& /*memory*/,
             JointVector& q) const noexcept override {
    const int n = static_cast<int>(q.size());
    for (int j = 0; j < n; ++j) {
      const double T = value(n + j);
      if (value(j) != 0.0) q(j) += value(j) * (T > 0.0 ? -std::expm1(-context.time / T) : 1.0);
    }
  }
};

}  // namespace

std::unique_ptr<Effect> makeCreep(const KinematicChain& robot) {
  return std::make_unique<Creep>(robot);
}

}  // namespace raven_correction
