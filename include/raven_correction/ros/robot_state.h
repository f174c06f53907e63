// SPDX-License-Identifier: BSD-3-Clause
// Whether the robot is enabled and homed, from the state messages of all three stacks, without
// their packages: one subscriber takes any type and knows it by its md5 sum.
#pragma once

#include <optional>
#include <string>

#include "raven_correction/ros/byte_reader.h"
#include "raven_correction/ros/raw_message.h"

namespace raven_correction {

struct AnyType {
  static const char* datatype() noexcept { return "*"; }
  static const char* md5sum() noexcept { return "*"; }
  static const char* definition() noexcept { return ""; }
};
using AnyMessage = RawMessage<AnyType>;

struct RobotState {
  bool enabled = false;
  bool homed = false;
  bool ready() const noexcept { return enabled && homed; }
};

/// crtk_msgs/operating_state and crtk_msgs/OperatingState (CRTK): enabled is the state ENABLED.
/// raven_2_msgs/RavenState (Berkeley) and raven_2/raven_state (UW): a run level of 2 or 3. The
/// pedal is up in level 2, but the tool stays where it was corrected to, so the correction stays,
/// too.
/// @param md5sum  of the message, from its connection header
/// @return nothing for another type, or bytes that are too few
std::optional<RobotState> readRobotState(const std::string& md5sum,
                                         const std::vector<std::uint8_t>& bytes) noexcept;

}  // namespace raven_correction
