// SPDX-License-Identifier: BSD-3-Clause
// Walks through the bytes of a serialised ROS message without allocation, never past their end.
#pragma once

#include <ros/time.h>

#include <cstdint>
#include <cstring>
#include <string_view>
#include <vector>

namespace raven_correction {

/// ROS 1 writes numbers little-endian and unaligned, strings and arrays behind a count of 32 bits.
/// After a read past the end ok() is false, and every further one gives zero.
class ByteReader {
 public:
  explicit ByteReader(const std::vector<std::uint8_t>& bytes) noexcept
      : data_(bytes.data()), size_(bytes.size()) {}
  explicit ByteReader(std::string_view bytes) noexcept
      : data_(reinterpret_cast<const std::uint8_t*>(bytes.data())), size_(bytes.size()) {}

  bool ok() const noexcept { return ok_; }
  bool atEnd() const noexcept { return ok_ && place_ == size_; }
  /// Bytes before the next one to be read.
  std::size_t place() const noexcept { return place_; }

  template <typename Number>
  Number number() noexcept {
    Number value{};
    if (const std::uint8_t* const at = take(sizeof(Number))) std::memcpy(&value, at, sizeof value);
    return value;
  }
  bool flag() noexcept { return number<std::uint8_t>() != 0; }
  std::string_view text() noexcept {
    const std::size_t length = number<std::uint32_t>();
    const std::uint8_t* const at = take(length);
    return at == nullptr ? std::string_view()
                         : std::string_view(reinterpret_cast<const char*>(at), length);
  }
  /// An array of elements of a fixed size.
  void skipArray(std::size_t element_size) noexcept {
    const std::size_t count = number<std::uint32_t>();  // 32 bits each: the product fits into 64
    take(count * element_size);
  }
  ros::Time time() noexcept {
    const auto seconds = number<std::uint32_t>();
    const auto nanoseconds = number<std::uint32_t>();
    // Written so that a time that is none does not throw.
    ros::Time time;
    time.sec = seconds;
    time.nsec = nanoseconds;
    return time;
  }

 private:
  const std::uint8_t* take(std::size_t count) noexcept {
    if (!ok_ || count > size_ - place_) {
      ok_ = false;
      return nullptr;
    }
    const std::uint8_t* const at = data_ + place_;
    place_ += count;
    return at;
  }

  const std::uint8_t* data_;
  std::size_t size_;
  std::size_t place_ = 0;
  bool ok_ = true;
};

}  // namespace raven_correction
