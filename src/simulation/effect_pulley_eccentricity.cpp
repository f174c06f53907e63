// SPDX-License-Identifier: BSD-3-Clause
// pulley_eccentricity: a pulley that does not run true adds a periodic error; N periods per radian
// (or metre) of the joint, 2 pi times the turns of the pulley.

#include <cmath>

#include "raven_correction/simulation/effect_registry.h"

namespace raven_correction {
namespace {

class PulleyEccentricity final : public Effect {
 public:
  explicit PulleyEccentricity(const KinematicChain& robot) {
    addJointParameters("A", robot, {"rad", 0.2, "m", 0.02}, Sign::kNotNegative);
    addJointParameters("N", robot, {"-", 200.0, "rad/m", 3000.0}, Sign::kNotNegative);
    addJointParameters("phi", robot, {"rad", 6.2831853071795865, "rad", 6.2831853071795865},
                       Sign::kBoth);
  }
  const char* name() const noexcept override { return "pulley_eccentricity"; }
  EffectStage stage() const noexcept override { return EffectStage::kCable; }
  const char* equation() const noexcept override { return "q = u + A sin(N u + phi)"; }
  std::unique_ptr<Effect> clone() const override {
    return std::make_unique<PulleyEccentricity>(*this);
  }

  void apply(const StepContext& /*context*/, JointVector& /*memory*/,
             JointVector& q) const noexcept override {
    const int n = static_cast<int>(q.size());
    for (int j = 0; j < n; ++j)
      if (value(j) != 0.0) q(j) += value(j) * std::sin(value(n + j) * q(j) + value(2 * n + j));
  }
};

}  // namespace

std::unique_ptr<Effect> makePulleyEccentricity(const KinematicChain& robot) {
  return std::make_unique<PulleyEccentricity>(robot);
}

}  // namespace raven_correction
