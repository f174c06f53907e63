// SPDX-License-Identifier: BSD-3-Clause
// A ROS message from bytes that may be damaged, such as a file's: a count is compared with the
// bytes that are left before memory is asked for. roscpp's own stream asks first, for up to 32 GB.
// Bytes of messages whose packages we do not have are byte_reader.h.
#pragma once

#include <ros/message_traits.h>
#include <ros/serialization.h>

#include <cstdint>
#include <vector>

#include "raven_correction/error.h"

namespace raven_correction {

/// As ros::serialization::IStream.
class CheckedStream : public ros::serialization::Stream {
 public:
  // The name that roscpp's templates ask for.
  static const ros::serialization::StreamType
      stream_type =  // NOLINT(readability-identifier-naming)
      ros::serialization::stream_types::Input;

  CheckedStream(std::uint8_t* data, std::uint32_t count) : Stream(data, count) {}

  template <typename T>
  void next(T& value) {
    ros::serialization::deserialize(*this, value);
  }
  template <typename T>
  void next(std::vector<T>& values) {
    CheckedStream ahead(getData(), getLength());
    std::uint32_t count = 0;
    ahead.next(count);
    const std::uint64_t smallest = ros::serialization::serializationLength(T());
    if (count * smallest > ahead.getLength()) ros::serialization::throwStreamOverrun();
    ros::serialization::deserialize(*this, values);
  }
  template <typename T>
  CheckedStream& operator>>(T& value) {
    next(value);
    return *this;
  }
};

/// @throws InvalidInput  the bytes are no such message: none, cut, too long, or damaged
template <typename Message>
Message messageFromBytes(std::vector<std::uint8_t> bytes) {
  Message message;
  CheckedStream stream(bytes.data(), static_cast<std::uint32_t>(bytes.size()));
  try {
    if (bytes.empty()) ros::serialization::throwStreamOverrun();
    stream.next(message);
  } catch (const ros::serialization::StreamOverrunException&) {
    throw InvalidInput(format("%zu bytes are no complete %s; is the file cut off or damaged?",
                              bytes.size(), ros::message_traits::datatype<Message>()));
  }
  if (stream.getLength() > 0)
    throw InvalidInput(format("a %s ends %u bytes before its record does; the file is damaged",
                              ros::message_traits::datatype<Message>(), stream.getLength()));
  return message;
}

}  // namespace raven_correction
