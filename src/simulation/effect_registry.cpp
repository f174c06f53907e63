// SPDX-License-Identifier: BSD-3-Clause
#include "raven_correction/simulation/effect_registry.h"

#include <algorithm>

#include "raven_correction/error.h"

// The catalogue, in acting order: one line per effect, EFFECT(X) for the function makeX().
#define RAVEN_CORRECTION_EFFECTS(EFFECT) \
  EFFECT(CommandDelay)                   \
  EFFECT(SpeedLimit)                     \
  EFFECT(TrackingLag)                    \
  EFFECT(DriveFriction)                  \
  EFFECT(MotorSaturation)                \
  EFFECT(JointGain)                      \
  EFFECT(JointCoupling)                  \
  EFFECT(PulleyEccentricity)             \
  EFFECT(Backlash)                       \
  EFFECT(CableStretch)                   \
  EFFECT(Creep)                          \
  EFFECT(JointOffset)                    \
  EFFECT(LinkGeometry)                   \
  EFFECT(BaseRegistration)               \
  EFFECT(ToolOffset)                     \
  EFFECT(MocapScale)                     \
  EFFECT(RegistrationShift)

namespace raven_correction {

#define RAVEN_CORRECTION_DECLARE(effect) \
  std::unique_ptr<Effect> make##effect(const KinematicChain& robot);
RAVEN_CORRECTION_EFFECTS(RAVEN_CORRECTION_DECLARE)
#undef RAVEN_CORRECTION_DECLARE

namespace {

using Maker = std::unique_ptr<Effect> (*)(const KinematicChain&);

const std::vector<Maker>& makers() {
#define RAVEN_CORRECTION_MAKER(effect) &make##effect,
  static const std::vector<Maker> all{RAVEN_CORRECTION_EFFECTS(RAVEN_CORRECTION_MAKER)};
#undef RAVEN_CORRECTION_MAKER
  return all;
}

std::vector<std::string> collectNames() {
  Joint joint;
  joint.name = "any";
  joint.upper = 1.0;
  const KinematicChain robot("any", "base", Pose(), {joint}, Pose());
  std::vector<std::string> names;
  for (const Maker make : makers()) names.push_back(make(robot)->name());
  return names;
}

}  // namespace

const std::vector<std::string>& effectNames() {
  static const std::vector<std::string> names = collectNames();
  return names;
}

int effectRank(const std::string& name) noexcept {
  const std::vector<std::string>& names = effectNames();
  const auto found = std::find(names.begin(), names.end(), name);
  return found == names.end() ? -1 : static_cast<int>(found - names.begin());
}

std::unique_ptr<Effect> makeEffect(const std::string& name, const KinematicChain& robot) {
  const int rank = effectRank(name);
  if (rank >= 0) return makers()[static_cast<std::size_t>(rank)](robot);
  std::string all;
  for (const std::string& known : effectNames()) all += (all.empty() ? "" : ", ") + known;
  throw InvalidInput(format("there is no effect %s; there are: %s", name.c_str(), all.c_str()));
}

}  // namespace raven_correction
