// SPDX-License-Identifier: BSD-3-Clause
// tracking_lag: a joint follows its set-point like a first-order low-pass. Exact for a set-point
// that is held during the step: q_k = u + (q_{k-1} - u) exp(-h / T).

#include <cmath>

#include "raven_correction/simulation/effect_registry.h"

namespace raven_correction {
namespace {

class TrackingLag final : public Effect {
 public:
  explicit TrackingLag(const KinematicChain& robot) {
    addJointParameters("T", robot, {"s", 2.0, "s", 2.0}, Sign::kNotNegative);
  }
  const char* name() const noexcept override { return "tracking_lag"; }
  EffectStage stage() const noexcept override { return EffectStage::kDrive; }
  const char* equation() const noexcept override { return "dq/dt = (u - q) / T"; }
  std::unique_ptr<Effect> clone() const override { return std::make_unique<TrackingLag>(*this); }

  bool remembers() const noexcept override { return true; }
  void apply(const StepContext& context, JointVector& memory,
             JointVector& q) const noexcept override {
    for (int j = 0; j < static_cast<int>(q.size()); ++j)
      if (value(j) > 0.0) q(j) += (memory(j) - q(j)) * std::exp(-context.step / value(j));
    memory = q;
  }
  void undo(const StepContext& /*context*/, JointVector& /*memory*/, JointVector& speed,
            JointVector& q) const noexcept override {
    for (int j = 0; j < static_cast<int>(q.size()); ++j) q(j) += value(j) * speed(j);
  }
};

}  // namespace

std::unique_ptr<Effect> makeTrackingLag(const KinematicChain& robot) {
  return std::make_unique<TrackingLag>(robot);
}

}  // namespace raven_correction
