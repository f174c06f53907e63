// SPDX-License-Identifier: BSD-3-Clause
#include "bag_structure.h"

#include <fcntl.h>
#include <rosbag/constants.h>
#include <rosbag/exceptions.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <string_view>
#include <utility>
#include <vector>

#include "bag_chunk.h"
#include "raven_correction/error.h"
#include "raven_correction/ros/byte_reader.h"

namespace raven_correction {
namespace {

constexpr std::string_view kVersion = "#ROSBAG V2.0\n";

[[noreturn]] void refuse(std::size_t place, const std::string& what) {
  throw rosbag::BagFormatException(format("byte %zu: %s", place, what.c_str()));
}

/// The bytes of a file, read when they are looked at.
class MappedFile {
 public:
  explicit MappedFile(const std::string& file) {
    const int descriptor = open(file.c_str(), O_RDONLY | O_CLOEXEC);
    struct stat status {};
    if (descriptor >= 0 && fstat(descriptor, &status) == 0 && status.st_size > 0) {
      size_ = static_cast<std::size_t>(status.st_size);
      data_ = mmap(nullptr, size_, PROT_READ, MAP_PRIVATE, descriptor, 0);
    }
    if (descriptor >= 0) close(descriptor);
    if (data_ == MAP_FAILED) throw rosbag::BagIOException("empty or not readable");
  }
  ~MappedFile() { munmap(data_, size_); }
  MappedFile(const MappedFile&) = delete;
  MappedFile& operator=(const MappedFile&) = delete;

  std::string_view bytes() const { return {static_cast<const char*>(data_), size_}; }

 private:
  void* data_ = MAP_FAILED;
  std::size_t size_ = 0;
};

/// `name=value` fields, each behind its length, as in headers and in the data of connections.
class Fields {
 public:
  /// @param place  of the fields in the file, for messages
  void read(std::string_view bytes, std::size_t place) {
    place_ = place;
    fields_.clear();
    ByteReader reader(bytes);
    while (!reader.atEnd()) {
      const std::size_t at = place + reader.place();
      const std::string_view field = reader.text();
      const std::size_t delimiter = field.find(static_cast<char>(rosbag::FIELD_DELIM));
      if (!reader.ok()) refuse(at, "a field goes on beyond its header");
      if (delimiter == std::string_view::npos) refuse(at, "a field without a value");
      fields_.emplace_back(field.substr(0, delimiter), field.substr(delimiter + 1));
    }
    std::sort(fields_.begin(), fields_.end());
    const auto twice =
        std::adjacent_find(fields_.begin(), fields_.end(),
                           [](const auto& a, const auto& b) { return a.first == b.first; });
    // Which of them rosbag would take is not for us to know.
    if (twice != fields_.end())
      refuse(place, format("the field %s comes twice", std::string(twice->first).c_str()));
  }
  bool has(const std::string& name) const { return find(name) != fields_.end(); }
  std::string_view text(const std::string& name) const {
    const auto field = find(name);
    if (field == fields_.end()) refuse(place_, "the field " + name + " is missing");
    return field->second;
  }
  template <typename Number>
  Number number(const std::string& name) const {
    const std::string_view value = text(name);
    Number number{};
    if (value.size() != sizeof number)
      refuse(place_, format("the field %s has %zu bytes, must have %zu", name.c_str(), value.size(),
                            sizeof number));
    std::memcpy(&number, value.data(), sizeof number);
    return number;
  }

 private:
  using List = std::vector<std::pair<std::string_view, std::string_view>>;
  List::const_iterator find(std::string_view name) const {
    const auto field = std::lower_bound(
        fields_.begin(), fields_.end(), name,
        [](const auto& one, std::string_view wanted) { return one.first < wanted; });
    return field != fields_.end() && field->first == name ? field : fields_.end();
  }

  List fields_;  ///< ordered by name
  std::size_t place_ = 0;
};

/// One record: its fields and its data.
struct Record {
  std::size_t place = 0, data_place = 0;
  Fields fields;
  std::string_view data;
  std::uint8_t kind = 0;

  /// @param start  place of the reader's first byte in the file
  void read(ByteReader& reader, std::size_t start) {
    place = start + reader.place();
    const std::string_view header = reader.text();
    const std::size_t header_place = start + reader.place() - header.size();
    data = reader.text();
    data_place = start + reader.place() - data.size();
    if (!reader.ok()) refuse(place, "a record goes on beyond the end; is the file cut off?");
    fields.read(header, header_place);
    kind = fields.number<std::uint8_t>(rosbag::OP_FIELD_NAME);
  }
};

/// Where there are records of one kind, in ascending order.
using Places = std::vector<std::uint64_t>;

bool contains(const Places& places, std::uint64_t place) {
  return std::binary_search(places.begin(), places.end(), place);
}

class StructureCheck {
 public:
  explicit StructureCheck(BagParts parts) : parts_(parts) {}

  void run(std::string_view bytes) {
    if (bytes.substr(0, kVersion.size()) != kVersion) refuse(0, "no bag of version 2.0");
    ByteReader reader(bytes.substr(kVersion.size()));
    Record record;
    record.read(reader, kVersion.size());
    if (record.kind != rosbag::OP_FILE_HEADER) refuse(record.place, "no header of a bag");
    if (record.fields.has(rosbag::ENCRYPTOR_FIELD_NAME) &&
        !record.fields.text(rosbag::ENCRYPTOR_FIELD_NAME).empty())
      refuse(record.place, "the bag is encrypted: rosbag decrypt makes one that can be read");
    const auto index = record.fields.number<std::uint64_t>(rosbag::INDEX_POS_FIELD_NAME);
    if (index == 0) return;
    Places places;
    while (!reader.atEnd()) {
      record.read(reader, kVersion.size());
      places.push_back(record.place);
      check(record);
    }
    if (index != bytes.size() && !contains(places, index))
      refuse(kVersion.size(), "the index is not where the header says");
    for (const std::uint64_t place : summarised_)
      if (!contains(chunks_, place)) refuse(place, "the index names a chunk that is not there");
  }

 private:
  void check(const Record& record) {
    switch (record.kind) {
      case rosbag::OP_CHUNK:
        checkChunk(record);
        break;
      case rosbag::OP_CONNECTION:
        checkConnection(record);
        break;
      case rosbag::OP_INDEX_DATA:
        checkIndex(record);
        break;
      case rosbag::OP_CHUNK_INFO:
        checkSummary(record);
        break;
      default:  // rosbag refuses what it does not expect
        break;
    }
  }

  /// Chunks hold connections and messages.
  void checkChunk(const Record& chunk) {
    chunks_.push_back(chunk.place);
    messages_.clear();
    const std::string_view compression = chunk.fields.text(rosbag::COMPRESSION_FIELD_NAME);
    const auto size = chunk.fields.number<std::uint32_t>(rosbag::SIZE_FIELD_NAME);
    if (parts_ == BagParts::kTopics) return;
    if (compression == rosbag::COMPRESSION_NONE) {
      if (size != chunk.data.size()) refuse(chunk.place, "the chunk is not as long as it says");
      return checkContent(chunk.data, chunk.data_place);
    }
    try {
      unpackChunk(compression, chunk.data, size, unpacked_);
      checkContent({reinterpret_cast<const char*>(unpacked_.data()), unpacked_.size()}, 0);
    } catch (const rosbag::BagException& error) {
      refuse(chunk.place, format("of the packed chunk: %s", error.what()));
    }
  }

  /// @param place  of the content in the file, or in what was unpacked
  void checkContent(std::string_view content, std::size_t place) {
    ByteReader reader(content);
    while (!reader.atEnd()) {
      const std::size_t offset = reader.place();
      inner_.read(reader, place);
      if (inner_.kind == rosbag::OP_CONNECTION) checkConnection(inner_);
      if (inner_.kind == rosbag::OP_MSG_DATA) messages_.push_back(offset);
    }
  }

  /// What rosbag takes from its data without asking whether it is there.
  void checkConnection(const Record& connection) {
    connection.fields.number<std::uint32_t>(rosbag::CONNECTION_FIELD_NAME);
    connection.fields.text(rosbag::TOPIC_FIELD_NAME);
    header_.read(connection.data, connection.data_place);
    for (const char* const field : {"type", "md5sum", "message_definition"}) header_.text(field);
  }

  /// Times and places of the messages of one connection in the chunk before.
  void checkIndex(const Record& index) {
    const std::uint64_t count = index.fields.number<std::uint32_t>(rosbag::COUNT_FIELD_NAME);
    ByteReader reader(index.data);
    for (std::uint64_t i = 0; i < count && reader.ok(); ++i) {
      reader.number<std::uint64_t>();  // time
      const auto offset = reader.number<std::uint32_t>();
      if (reader.ok() && parts_ == BagParts::kAll && !contains(messages_, offset))
        refuse(index.place, format("the index names a message at %u of its chunk, where none is",
                                   static_cast<unsigned>(offset)));
    }
    if (!reader.atEnd()) refuse(index.place, "the index is not as long as it says");
  }

  void checkSummary(const Record& summary) {
    summarised_.push_back(summary.fields.number<std::uint64_t>(rosbag::CHUNK_POS_FIELD_NAME));
    const std::uint64_t count = summary.fields.number<std::uint32_t>(rosbag::COUNT_FIELD_NAME);
    if (summary.data.size() != count * 2 * sizeof(std::uint32_t))
      refuse(summary.place, "the summary of a chunk is not as long as it says");
  }

  Places chunks_, summarised_;
  Places messages_;  ///< of the last chunk, within it
  const BagParts parts_;
  std::vector<std::uint8_t> unpacked_;
  Record inner_;   ///< within a chunk; a member for its memory
  Fields header_;  ///< of a connection
};

}  // namespace

void checkBagStructure(const std::string& file, BagParts parts) {
  const MappedFile mapped(file);
  StructureCheck(parts).run(mapped.bytes());
}

}  // namespace raven_correction
