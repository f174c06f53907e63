// SPDX-License-Identifier: BSD-3-Clause
// tool_offset: the markers sit elsewhere on the tool than assumed. x, y, z and rx, ry, rz are the
// pose of the observed frame in the nominal tool frame.

#include "raven_correction/simulation/effect_registry.h"

namespace raven_correction {
namespace {

class ToolOffset final : public Effect {
 public:
  explicit ToolOffset(const KinematicChain& /*robot*/) { addPoseParameters(0.1, 3.14); }
  const char* name() const noexcept override { return "tool_offset"; }
  EffectStage stage() const noexcept override { return EffectStage::kKinematics; }
  const char* equation() const noexcept override { return "X_observed = X_base_tool X_err"; }
  std::unique_ptr<Effect> clone() const override { return std::make_unique<ToolOffset>(*this); }

  Pose tool() const noexcept override { return poseValue(0); }
};

}  // namespace

std::unique_ptr<Effect> makeToolOffset(const KinematicChain& robot) {
  return std::make_unique<ToolOffset>(robot);
}

}  // namespace raven_correction
