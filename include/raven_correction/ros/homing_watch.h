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
  static constexpr double kSilence = 2.0;  ///< that may hide a homing, if it is not expected [s]

  enum class Homing {
    kNone,     ///< the robot is as it was
    kSeen,     ///< it is homed and was not
    kPossible  ///< it is homed, as it was before its state was silent for so long
  };
  /// @param silence  a longer one may hide a homing; not shorter than the states are apart [s]
  explicit HomingWatch(double silence = kSilence) : silence_(silence) {}
  /// The first state of all tells of no homing: nothing is known of the time before.
  /// @param arrival  of the state, of one clock; where it goes back no silence is seen [s]
  Homing update(const RobotState& state, double arrival) noexcept;
  const std::optional<RobotState>& state() const noexcept { return state_; }  ///< the last one
  double at() const noexcept { return at_; }  ///< when that arrived [s]

 private:
  double silence_;
  std::optional<RobotState> state_;
  double at_ = 0.0;
};

/// For people: "was homed" or "may have been homed while its state was silent".
const char* homingText(HomingWatch::Homing homing) noexcept;

}  // namespace raven_correction
