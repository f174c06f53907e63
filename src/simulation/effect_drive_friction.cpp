// SPDX-License-Identifier: BSD-3-Clause
// drive_friction: Coulomb friction F_c holds a motor back from its set-point where the controller's
// proportional gain k_p cannot overcome it: it stops short by up to w/2, w = 2 F_c / k_p, against
// the motion. Encoders see it (unlike backlash).
#include "play_effect.h"

namespace raven_correction {
namespace {

class DriveFriction final : public PlayEffect {
 public:
  using PlayEffect::PlayEffect;
  const char* name() const noexcept override { return "drive_friction"; }
  EffectStage stage() const noexcept override { return EffectStage::kDrive; }
  std::unique_ptr<Effect> clone() const override { return std::make_unique<DriveFriction>(*this); }
};

}  // namespace

std::unique_ptr<Effect> makeDriveFriction(const KinematicChain& robot) {
  return std::make_unique<DriveFriction>(robot);
}

}  // namespace raven_correction
