// SPDX-License-Identifier: BSD-3-Clause
// A message of a package that we do not depend on, as the bytes that travel. It is subscribed to
// and published under the datatype and md5 sum of the real one, so that the real nodes connect, and
// forwarded byte for byte. What the bytes mean is read by raven_command.h and robot_state.h.
#pragma once

#include <ros/message_traits.h>
#include <ros/serialization.h>

#include <cstdint>
#include <cstring>
#include <vector>

namespace raven_correction {

/// @tparam Type  has the static functions datatype(), md5sum() and definition(), as genmsg makes
///               them; md5sum() "*" takes messages of any type
template <typename Type>
struct RawMessage {
  std::vector<std::uint8_t> bytes;
};

}  // namespace raven_correction

namespace ros {
namespace message_traits {

template <typename Type>
struct IsMessage<raven_correction::RawMessage<Type>> : TrueType {};
template <typename Type>
struct IsMessage<const raven_correction::RawMessage<Type>> : TrueType {};

// HasHeader stays false: roscpp would write a sequence number of its own into the header.

template <typename Type>
struct MD5Sum<raven_correction::RawMessage<Type>> {
  static const char* value() { return Type::md5sum(); }
  static const char* value(const raven_correction::RawMessage<Type>&) { return value(); }
};

template <typename Type>
struct DataType<raven_correction::RawMessage<Type>> {
  static const char* value() { return Type::datatype(); }
  static const char* value(const raven_correction::RawMessage<Type>&) { return value(); }
};

template <typename Type>
struct Definition<raven_correction::RawMessage<Type>> {
  static const char* value() { return Type::definition(); }
  static const char* value(const raven_correction::RawMessage<Type>&) { return value(); }
};

}  // namespace message_traits

namespace serialization {

template <typename Type>
struct Serializer<raven_correction::RawMessage<Type>> {
  using Message = raven_correction::RawMessage<Type>;

  template <typename Stream>
  static void write(Stream& stream, const Message& message) {
    const auto size = static_cast<std::uint32_t>(message.bytes.size());
    if (size > 0) std::memcpy(stream.advance(size), message.bytes.data(), size);
  }
  template <typename Stream>
  static void read(Stream& stream, Message& message) {
    const std::uint32_t size = stream.getLength();
    message.bytes.assign(stream.getData(), stream.getData() + size);
    stream.advance(size);
  }
  static std::uint32_t serializedLength(const Message& message) {
    return static_cast<std::uint32_t>(message.bytes.size());
  }
};

}  // namespace serialization
}  // namespace ros
