// SPDX-License-Identifier: BSD-3-Clause
#include "raven_correction/ros/homing_watch.h"

namespace raven_correction {

HomingWatch::Homing HomingWatch::update(const RobotState& state, double arrival) noexcept {
  const bool first = !state_;
  const bool was_homed = !first && state_->homed;
  const bool was_silent = !first && arrival - at_ > silence_;
  state_ = state;
  at_ = arrival;
  if (first || !state.homed) return Homing::kNone;
  if (!was_homed) return Homing::kSeen;
  return was_silent ? Homing::kPossible : Homing::kNone;
}

const char* homingText(HomingWatch::Homing homing) noexcept {
  return homing == HomingWatch::Homing::kPossible ? "may have been homed while its state was silent"
                                                  : "was homed";
}

}  // namespace raven_correction
