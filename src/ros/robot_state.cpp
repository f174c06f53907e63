// SPDX-License-Identifier: BSD-3-Clause
#include "raven_correction/ros/robot_state.h"

namespace raven_correction {
namespace {

constexpr char kOperatingState[] = "b1bd4021639d9d9c5fbfff78d6ff3158";
constexpr char kBerkeleyState[] = "2489ec3d939b556c05d31ea2958841b2";
constexpr char kUwState[] = "ce9e7f4969049d8bb365de3c98461a01";
constexpr std::int32_t kHomedLevel = 2;  // 0 emergency stop, 1 homing, 2 pedal up, 3 pedal down

RobotState stateOfLevel(std::int32_t level) noexcept {
  const bool homed = level >= kHomedLevel;
  return {homed, homed};
}

}  // namespace

std::optional<RobotState> readRobotState(const std::string& md5sum,
                                         const std::vector<std::uint8_t>& bytes) noexcept {
  ByteReader reader(bytes);
  reader.number<std::uint32_t>();  // header: seq, stamp, frame
  reader.time();
  reader.text();
  RobotState state;
  if (md5sum == kOperatingState) {
    state.enabled = reader.text() == "ENABLED";
    state.homed = reader.flag();
    reader.flag();  // is_busy
    if (!reader.atEnd()) return std::nullopt;
  } else if (md5sum == kBerkeleyState) {
    state = stateOfLevel(reader.number<std::uint8_t>());
  } else if (md5sum == kUwState) {
    state = stateOfLevel(reader.number<std::int32_t>());
  } else {
    return std::nullopt;
  }
  if (!reader.ok()) return std::nullopt;
  return state;
}

}  // namespace raven_correction
