// SPDX-License-Identifier: BSD-3-Clause
// Compressed chunks of every size, and what they claim to be.
#include "../../src/ros/bag_chunk.h"

#include <bzlib.h>
#include <gtest/gtest.h>
#include <rosbag/chunked_file.h>
#include <rosbag/exceptions.h>
#include <roslz4/lz4s.h>

#include <random>
#include <string>

namespace raven_correction {
namespace {

std::string content(std::size_t size) {
  std::mt19937 random(static_cast<unsigned>(size));
  std::string bytes(size, 'a');
  for (std::size_t i = 0; i < size; i += 3) bytes[i] = static_cast<char>(random() % 7);
  return bytes;
}

std::string packedBz2(std::string bytes) {
  std::string packed(bytes.size() + bytes.size() / 100 + 600, '\0');
  auto size = static_cast<unsigned>(packed.size());
  EXPECT_EQ(BZ2_bzBuffToBuffCompress(packed.data(), &size, bytes.data(),
                                     static_cast<unsigned>(bytes.size()), 9, 0, 30),
            BZ_OK);
  packed.resize(size);
  return packed;
}

std::string packedLz4(std::string bytes) {
  std::string packed(bytes.size() + bytes.size() / 100 + 600, '\0');
  auto size = static_cast<unsigned>(packed.size());
  EXPECT_EQ(roslz4_buffToBuffCompress(bytes.data(), static_cast<unsigned>(bytes.size()),
                                      packed.data(), &size, 6),
            ROSLZ4_OK);
  packed.resize(size);
  return packed;
}

class BagChunk : public ::testing::TestWithParam<const char*> {
 protected:
  static std::string packed(const std::string& bytes) {
    return GetParam() == std::string("bz2") ? packedBz2(bytes) : packedLz4(bytes);
  }
};

TEST_P(BagChunk, IsUnpackedIfItHasTheSizeThatItSays) {
  for (const std::size_t size : {1, 65535, 65536, 65537, 131072, 1000000}) {
    const std::string bytes = content(size), small = packed(bytes);
    std::vector<std::uint8_t> unpacked(3);
    const auto claimed = static_cast<std::uint32_t>(size);
    unpackChunk(GetParam(), small, claimed, unpacked);
    EXPECT_EQ(std::string(unpacked.begin(), unpacked.end()), bytes) << size;
    EXPECT_THROW(unpackChunk(GetParam(), small, claimed + 1, unpacked), rosbag::BagException)
        << size;
    EXPECT_THROW(unpackChunk(GetParam(), small, claimed - 1, unpacked), rosbag::BagException)
        << size;
    if (size > 1) {
      EXPECT_THROW(unpackChunk(GetParam(), small.substr(0, small.size() / 2), claimed, unpacked),
                   rosbag::BagException)
          << size;
    }
  }
}

TEST_P(BagChunk, WhatItClaimsTakesNoMemory) {
  const std::string bytes = content(100000), small = packed(bytes);
  std::vector<std::uint8_t> unpacked;
  EXPECT_THROW(unpackChunk(GetParam(), small, 0xffffffff, unpacked), rosbag::BagException);
  EXPECT_LE(unpacked.capacity(), 3 * bytes.size());
}

TEST_P(BagChunk, ManyZerosAreFewBytes) {
  const std::string bytes(3000000, '\0');
  std::vector<std::uint8_t> unpacked;
  unpackChunk(GetParam(), packed(bytes), static_cast<std::uint32_t>(bytes.size()), unpacked);
  EXPECT_EQ(unpacked.size(), bytes.size());
}

INSTANTIATE_TEST_SUITE_P(Compression, BagChunk, ::testing::Values("bz2", "lz4"));

TEST(BagChunkOfAnotherKind, IsRefused) {
  std::vector<std::uint8_t> unpacked;
  EXPECT_THROW(unpackChunk("zip", "abc", 3, unpacked), rosbag::BagException);
}

}  // namespace
}  // namespace raven_correction
