// SPDX-License-Identifier: BSD-3-Clause
// Bags to read, sound and damaged: whatever byte of one is wrong, it is read or refused, and rosbag
// is never led beyond its memory (which the builds of ./run sanitize would see).
#include "raven_correction/ros/bag_file.h"

#include <console_bridge/console.h>
#include <gtest/gtest.h>
#include <rosbag/view.h>
#include <std_msgs/String.h>

#include <cstring>
#include <fstream>
#include <iterator>

#include "support/temporary_directory.h"

namespace raven_correction {
namespace {

constexpr std::size_t kMessages = 4;

std::string contentOf(const std::string& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
}

/// Two chunks of messages of two connections.
std::string makeBag(const std::string& file, rosbag::compression::CompressionType compression) {
  rosbag::Bag bag(file, rosbag::bagmode::Write);
  bag.setCompression(compression);
  bag.setChunkThreshold(500);
  std_msgs::String message;
  for (std::size_t i = 0; i < kMessages; ++i) {
    message.data = "message " + std::to_string(i) + " of some length";
    bag.write(i % 3 == 0 ? "a" : "b", ros::Time(100.0 + static_cast<double>(i)), message);
  }
  bag.close();
  return contentOf(file);
}

/// With a publisher whose header does not say its type.
std::string makeNamelessBag(const std::string& file,
                            rosbag::compression::CompressionType compression) {
  rosbag::Bag bag(file, rosbag::bagmode::Write);
  bag.setCompression(compression);
  const auto header = boost::make_shared<ros::M_string>();
  (*header)["md5sum"] = "992ce8a1687cec8c8bd883ec73ca41d1";
  (*header)["message_definition"] = "string data";
  bag.write("a", ros::Time(100.0), std_msgs::String(), header);
  bag.close();
  return contentOf(file);
}

/// How many messages are read from these bytes.
std::size_t messagesIn(const std::string& bytes, const std::string& file) {
  std::ofstream(file, std::ios::binary) << bytes;
  const rosbag::Bag bag = openBagFile(file);
  std::size_t count = 0;
  for (const rosbag::MessageInstance& instance : rosbag::View(bag)) {
    std::vector<std::uint8_t> message(instance.size());
    ros::serialization::OStream stream(message.data(), instance.size());
    instance.write(stream);
    ++count;
  }
  return count;
}

std::string complaint(const std::string& bytes, const std::string& file) {
  try {
    messagesIn(bytes, file);
  } catch (const rosbag::BagException& error) {
    return error.what();
  }
  return "accepted";
}

/// The bytes with the number at this place replaced.
std::string with(std::string bytes, std::size_t place, std::uint32_t number) {
  std::memcpy(&bytes.at(place), &number, sizeof number);
  return bytes;
}

class BagFile : public ::testing::Test {
 protected:
  const TemporaryDirectory folder_;
  const std::string file_ = folder_.path() + "/b.bag";
  const std::string sound_ = makeBag(file_, rosbag::compression::Uncompressed);

  void expectComplaint(const std::string& bytes, const std::string& what) const {
    const std::string said = complaint(bytes, file_);
    EXPECT_NE(said.find(what), std::string::npos) << said;
    EXPECT_NE(said.find("byte "), std::string::npos) << said;
  }
};

TEST_F(BagFile, SoundOnesAreReadHoweverTheyAreCompressed) {
  for (const auto compression :
       {rosbag::compression::Uncompressed, rosbag::compression::BZ2, rosbag::compression::LZ4})
    EXPECT_EQ(messagesIn(makeBag(file_, compression), file_), kMessages);
}

TEST_F(BagFile, DamagedLengthsAndPlacesAreNamedWithTheirByte) {
  const std::size_t header = sound_.find('\n') + 1;
  expectComplaint("#ROSBAG V1.2\n" + sound_.substr(header), "no bag of version 2.0");
  expectComplaint(with(sound_, header, 0x7fffffff), "a record goes on beyond the end");
  expectComplaint(with(sound_, header + 4, 0x7fff), "a field goes on beyond its header");
  const auto value = [&](const std::string& field, std::size_t from = 0) {
    return sound_.find(field + "=", from) + field.size() + 1;
  };
  expectComplaint(with(sound_, value("index_pos"), 4000), "the index is not where");
  expectComplaint(with(sound_, value("size"), 1), "the chunk is not as long");
  expectComplaint(with(sound_, value("chunk_pos"), 77), "names a chunk that is not there");
  const std::size_t chunk = value("size");
  // The first of the chunk: a connection, whose data is the header of its publisher.
  const std::size_t type = sound_.find("type=", chunk);
  std::string nameless = sound_;
  nameless[type] = 'T';
  expectComplaint(nameless, "the field type is missing");
  std::string no_value = sound_;
  no_value[type + 4] = ' ';
  expectComplaint(no_value, "a field without a value");
  // Index of the first chunk: its header ends with the data's length, then a time, then the place.
  const std::size_t index = sound_.find("ver=", chunk);
  expectComplaint(with(sound_, value("count", index), 1000), "the index is not as long");
  const std::size_t time = sound_.find(std::string("\x64\0\0\0\0\0\0\0", 8), index);
  ASSERT_NE(time, std::string::npos);
  expectComplaint(with(sound_, time + 8, 3), "names a message at 3 of its chunk");
}

TEST_F(BagFile, AFieldThatComesTwiceIsRefused) {
  // What was looked at must be what rosbag follows, whichever of them that is.
  const std::size_t time = sound_.find("time=");  // of the first message, behind its connection
  ASSERT_NE(time, std::string::npos);
  std::string twice = sound_;
  twice.replace(time, 4, "conn");
  expectComplaint(twice, "the field conn comes twice");
}

TEST_F(BagFile, DamageWithinACompressedChunkIsFoundThere) {
  for (const auto compression : {rosbag::compression::BZ2, rosbag::compression::LZ4}) {
    const std::string packed = makeBag(file_, compression);
    const std::size_t size = packed.find("size=", packed.find("compression=")) + 5;
    std::uint32_t unpacked = 0;
    std::memcpy(&unpacked, &packed.at(size), sizeof unpacked);
    for (const std::uint32_t wrong : {unpacked - 1, unpacked + 4, unpacked + 100, 0u, 0xffffffffu})
      expectComplaint(with(packed, size, wrong), "of the packed chunk: ");
    const std::size_t index = packed.find("ver=", size);
    const std::size_t time = packed.find(std::string("\x64\0\0\0\0\0\0\0", 8), index);
    ASSERT_NE(time, std::string::npos);
    expectComplaint(with(packed, time + 8, 3), "names a message at 3 of its chunk");
    expectComplaint(with(packed, time + 8, unpacked - 4), "names a message at ");
    const std::string nameless = complaint(makeNamelessBag(file_, compression), file_);
    EXPECT_NE(nameless.find("of the packed chunk: byte "), std::string::npos) << nameless;
    EXPECT_NE(nameless.find("the field type is missing"), std::string::npos) << nameless;
    // Its topics are known without unpacking.
    std::string flipped = packed;
    flipped[size + 8] ^= 1;  // what is packed begins behind its length
    expectComplaint(flipped, "of the packed chunk: ");
    EXPECT_EQ(rosbag::View(openBagFile(file_, BagParts::kTopics)).getConnections().size(), 2u);
  }
}

TEST_F(BagFile, WithoutAnIndexItIsRosbagThatSaysSo) {
  const std::size_t place = sound_.find("index_pos=") + 10;
  EXPECT_THROW(messagesIn(with(with(sound_, place, 0), place + 4, 0), file_),
               rosbag::BagUnindexedException);
  EXPECT_THROW(openBagFile(folder_.path()), rosbag::BagException);
  EXPECT_THROW(messagesIn("", file_), rosbag::BagException);
}

TEST_F(BagFile, WhateverIsDamagedIsReadOrRefusedHoweverItIsCompressed) {
  console_bridge::setLogLevel(console_bridge::CONSOLE_BRIDGE_LOG_NONE);  // rosbag tells each
  const auto readOrRefuse = [&](const std::string& bytes) {
    try {
      messagesIn(bytes, file_);
      return true;
    } catch (const ros::Exception&) {
    } catch (const std::length_error&) {
    } catch (const std::bad_alloc&) {
    }
    return false;
  };
  for (const auto compression :
       {rosbag::compression::Uncompressed, rosbag::compression::BZ2, rosbag::compression::LZ4}) {
    const std::string sound = makeBag(file_, compression);
    // Not within the spaces that the header of a bag is filled up with.
    const std::size_t spaces = sound.find("   "), records = sound.find_first_not_of(' ', spaces);
    std::size_t refused = 0;
    for (std::size_t at = 0; at + 4 <= sound.size(); ++at) {
      if (at == spaces) at = records - 4;
      for (const std::uint32_t number : {0xffu, 0xffffffffu})
        refused += readOrRefuse(with(sound, at, number)) ? 0 : 1;
    }
    EXPECT_GT(2 * refused, sound.size() - (records - spaces)) << compression;
    for (std::size_t size = 0; size < sound.size();
         size += 1 + (size > spaces && size < records) * 40)
      EXPECT_FALSE(readOrRefuse(sound.substr(0, size))) << compression << " " << size;
  }
}

}  // namespace
}  // namespace raven_correction
