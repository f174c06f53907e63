// SPDX-License-Identifier: BSD-3-Clause
// When the robot was homed, or may have been, by the states that it reports: what was learnt about
// its cables before is worth less from then on.
#pragma once

#include <optional>

#include "raven_correction/ros/robot_state.h"

namespace raven_correction {

/// Of one thread.
class HomingWatch {
 public:
  /// A silence that is longer may hide a homing [s].
  static constexpr double kSilence = 2.0;

  enum class Homing {
    kNone,     ///< the robot is as it was
    kSeen,     ///< it is homed and was not
    kPossible  ///< it is homed, as it was before its state was silent for so long
  };
  /// The first state of all tells of no homing: nothing is known of the time before.
  /// @param steady  when it arrived, of a steady clock [s]
  Homing update(const RobotState& state, double steady) noexcept;
  const std::optional<RobotState>& state() const noexcept { return state_; }  ///< the last one
  double at() const noexcept { return at_; }  ///< when that arrived [s]

 private:
  std::optional<RobotState> state_;
  double at_ = 0.0;
};

/// For people: "was homed" or "may have been homed while its state was silent".
const char* homingText(HomingWatch::Homing homing) noexcept;

}  // namespace raven_correction
