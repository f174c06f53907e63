// SPDX-License-Identifier: BSD-3-Clause
// raven_2_msgs/RavenCommand, the command of the Berkeley stack, which carries both arms: read from
// and written into its bytes, without that package. Poses in single messages are pose_command.h.
#pragma once

#include <array>
#include <string_view>

#include "raven_correction/geometry/pose.h"
#include "raven_correction/ros/byte_reader.h"
#include "raven_correction/ros/raw_message.h"

namespace raven_correction {

struct RavenCommandType {
  static const char* datatype() noexcept { return "raven_2_msgs/RavenCommand"; }
  static const char* md5sum() noexcept { return "02b34bd728d23aaf997e47b9c67c0d8e"; }
  static const char* definition() noexcept;
};
using RavenCommand = RawMessage<RavenCommandType>;

/// Bits of ToolCommand.pose_option.
enum RavenPoseFlag : std::uint8_t {
  kRavenPositionEnabled = 1,
  kRavenPositionRelative = 2,
  kRavenOrientationEnabled = 4,
  kRavenOrientationRelative = 8,
};

struct RavenArmCommand {
  std::string_view name;         ///< "L", "R"
  bool active = false;           ///< false: the controller skips the arm
  std::uint8_t pose_option = 0;  ///< RavenPoseFlag
  Pose pose;                     ///< [m]; what it means depends on pose_option
  std::size_t place = 0;         ///< of the pose in the bytes
};

/// What a command says; texts point into the bytes it was read from.
struct RavenCommandContent {
  static constexpr std::size_t kMaxArms = 8;
  ros::Time stamp;
  std::string_view frame;
  bool pedal_down = false;  ///< false: the controller writes nothing
  std::size_t arm_count = 0;
  std::array<RavenArmCommand, kMaxArms> arms;
};

/// No allocation. @return false if the bytes are no such message: cut or too long, names and arms
/// that do not match one another in number, more than kMaxArms, or a name that occurs twice
bool readRavenCommand(const std::vector<std::uint8_t>& bytes,
                      RavenCommandContent& content) noexcept;

/// Overwrites the parts of a pose. No allocation.
/// @param place  RavenArmCommand::place of the same bytes
void writeRavenPose(std::vector<std::uint8_t>& bytes, std::size_t place, const Pose& pose,
                    bool position, bool orientation) noexcept;

}  // namespace raven_correction
