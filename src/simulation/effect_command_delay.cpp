// SPDX-License-Identifier: BSD-3-Clause
// command_delay: set-points act tau later than the stamp of their command. Network, controller
// cycle and everything else that passes a command on unchanged but late.

#include "raven_correction/simulation/effect_registry.h"

namespace raven_correction {
namespace {

class CommandDelay final : public Effect {
 public:
  explicit CommandDelay(const KinematicChain& /*robot*/) { addParameter("tau", "s", 0.0, 2.0); }
  const char* name() const noexcept override { return "command_delay"; }
  EffectStage stage() const noexcept override { return EffectStage::kCommand; }
  const char* equation() const noexcept override { return "setpoint(t) = command(t - tau)"; }
  std::unique_ptr<Effect> clone() const override { return std::make_unique<CommandDelay>(*this); }

  double delay() const noexcept override { return value(0); }
};

}  // namespace

std::unique_ptr<Effect> makeCommandDelay(const KinematicChain& robot) {
  return std::make_unique<CommandDelay>(robot);
}

}  // namespace raven_correction
