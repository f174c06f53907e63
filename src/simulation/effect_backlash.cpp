// SPDX-License-Identifier: BSD-3-Clause
// backlash: play of full width w between motor and joint. A reversal travels w before the joint
// follows. Encoders do not see it (unlike drive_friction).
#include "play_effect.h"

namespace raven_correction {
namespace {

class Backlash final : public PlayEffect {
 public:
  using PlayEffect::PlayEffect;
  const char* name() const noexcept override { return "backlash"; }
  EffectStage stage() const noexcept override { return EffectStage::kCable; }
  std::unique_ptr<Effect> clone() const override { return std::make_unique<Backlash>(*this); }
};

}  // namespace

std::unique_ptr<Effect> makeBacklash(const KinematicChain& robot) {
  return std::make_unique<Backlash>(robot);
}

}  // namespace raven_correction
