// SPDX-License-Identifier: BSD-3-Clause
// Messages of raven_2_msgs as bytes, made for tests of what reads them, and by no code of ours.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "raven_correction/geometry/pose.h"

namespace raven_correction {

/// ROS 1 serialisation, written down anew.
class Bytes {
 public:
  template <typename Number>
  Bytes& put(Number value) {
    const auto* const at = reinterpret_cast<const std::uint8_t*>(&value);
    bytes_.insert(bytes_.end(), at, at + sizeof value);
    return *this;
  }
  Bytes& put(const std::string& text) {
    put(static_cast<std::uint32_t>(text.size()));
    bytes_.insert(bytes_.end(), text.begin(), text.end());
    return *this;
  }
  Bytes& header(const std::string& frame, std::uint32_t seconds = 100,
                std::uint32_t nanoseconds = 500000000) {
    return put(std::uint32_t{7}).put(seconds).put(nanoseconds).put(frame);
  }
  const std::vector<std::uint8_t>& get() const { return bytes_; }

 private:
  std::vector<std::uint8_t> bytes_;
};

/// What a raven_2_msgs/RavenCommand says of one arm.
struct ArmBytes {
  std::string name;
  std::uint8_t option;
  std::array<double, 7> pose;  ///< position [m], quaternion x, y, z, w
};

inline ArmBytes armBytes(const std::string& name, std::uint8_t option, const Pose& pose) {
  const Eigen::Vector4d& q = pose.q.coeffs();
  return {name, option, {pose.p.x(), pose.p.y(), pose.p.z(), q(0), q(1), q(2), q(3)}};
}

/// A raven_2_msgs/RavenCommand with the pedal down and these arms active.
inline std::vector<std::uint8_t> command(const std::vector<ArmBytes>& arms, std::uint32_t seconds,
                                         std::uint32_t nanoseconds) {
  Bytes bytes;
  const auto count = static_cast<std::uint32_t>(arms.size());
  bytes.header("0_link", seconds, nanoseconds).put(std::string("planner"));
  bytes.put<std::uint8_t>(1).put<std::uint8_t>(1).put(count);
  for (const ArmBytes& arm : arms) bytes.put(arm.name);
  bytes.put(count);
  for (const ArmBytes& arm : arms) {
    bytes.put<std::uint8_t>(1).put(arm.option);
    for (const double value : arm.pose) bytes.put(value);
    bytes.put<std::uint8_t>(0).put(0.0f).put<std::uint32_t>(0).put<std::uint32_t>(0);
  }
  return bytes.get();
}

/// A raven_2_msgs/RavenCommand with parts that no corrector looks at.
inline std::vector<std::uint8_t> command(const std::vector<std::string>& names,
                                         std::uint8_t option = 5, bool active = true,
                                         bool pedal_down = true) {
  Bytes bytes;
  bytes.header("0_link").put(std::string("planner")).put<std::uint8_t>(pedal_down);
  bytes.put<std::uint8_t>(1).put(static_cast<std::uint32_t>(names.size()));
  for (const std::string& name : names) bytes.put(name);
  bytes.put(static_cast<std::uint32_t>(names.size()));
  for (std::size_t i = 0; i < names.size(); ++i) {
    bytes.put<std::uint8_t>(active).put(option);
    for (const double value : {0.1, 0.2, 0.3, 0.5, 0.5, 0.5, -0.5})
      bytes.put(value + 10.0 * static_cast<double>(i));
    bytes.put<std::uint8_t>(1).put(0.25f);
    bytes.put<std::uint32_t>(2).put<std::uint16_t>(4).put<std::uint16_t>(5);
    bytes.put<std::uint32_t>(1).put<std::uint8_t>(1).put(0.75f);
  }
  return bytes.get();
}

}  // namespace raven_correction
