// SPDX-License-Identifier: BSD-3-Clause
#include "raven_correction/diagnosis/separating_recording.h"

namespace raven_correction {

std::string separatingRecording(const std::string& effect, const std::string& other) {
  const auto is = [&](const char* a, const char* b) {
    return (effect == a && other == b) || (effect == b && other == a);
  };
  if (is("drive_friction", "backlash"))
    return "record the encoders, too (measured_js): they see friction, and not backlash";
  if (is("command_delay", "tracking_lag"))
    return "record fast motions with sudden starts and reversals: a delay moves them unchanged, a "
           "lag rounds them off";
  if (is("joint_offset", "base_registration") || is("joint_offset", "tool_offset"))
    return "touch known points of the robot's base and of the tool with a tracked pointer: an "
           "offset "
           "of the first joint is a turn of the base, one of the last a turn of the tool, in every "
           "recording";
  if (is("base_registration", "registration_shift") || is("joint_offset", "creep"))
    return "record for longer, from before the change";
  if (is("cable_stretch", "joint_gain") || is("cable_stretch", "joint_coupling") ||
      is("cable_stretch", "joint_offset"))
    return "repeat the same motions with a known mass in the gripper: only the stretch changes";
  if (is("link_geometry", "joint_offset") || is("link_geometry", "base_registration") ||
      is("link_geometry", "tool_offset"))
    return "record over the whole workspace of all joints: what a wrong link does changes with the "
           "joints before it, an offset's does not";
  return "move each joint alone over its whole range, in both directions, at several speeds";
}

}  // namespace raven_correction
