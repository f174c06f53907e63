// SPDX-License-Identifier: BSD-3-Clause
// crtk_msgs/operating_state as bytes, so that tests need no package of it.
#pragma once

#include <cstdint>
#include <string>

#include "raven_correction/ros/raw_message.h"

namespace raven_correction {

struct OperatingStateType {
  static const char* datatype() { return "crtk_msgs/operating_state"; }
  static const char* md5sum() { return "b1bd4021639d9d9c5fbfff78d6ff3158"; }
  static const char* definition() { return ""; }
};

inline RawMessage<OperatingStateType> operatingState(const std::string& state, bool homed) {
  RawMessage<OperatingStateType> message;
  const auto put = [&](std::uint32_t value) {
    for (int i = 0; i < 4; ++i)
      message.bytes.push_back(static_cast<std::uint8_t>(value >> (8 * i) & 0xff));
  };
  put(1);  // seq
  put(2);  // stamp
  put(3);
  put(0);  // frame_id
  put(static_cast<std::uint32_t>(state.size()));
  message.bytes.insert(message.bytes.end(), state.begin(), state.end());
  message.bytes.push_back(homed);
  message.bytes.push_back(0);
  return message;
}

}  // namespace raven_correction
