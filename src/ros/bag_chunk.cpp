// SPDX-License-Identifier: BSD-3-Clause
#include "bag_chunk.h"

#include <bzlib.h>
#include <rosbag/chunked_file.h>
#include <rosbag/constants.h>
#include <rosbag/exceptions.h>

#include <algorithm>
#include <new>
#include <string>

#include "raven_correction/error.h"

namespace raven_correction {
namespace {

constexpr std::size_t kFirstPiece = 65536;
/// One byte of LZ4 stands for 255 at most; a frame and the first literals for some more.
constexpr std::size_t kMostOfLz4 = 256, kFrameOfLz4 = 1024;

[[noreturn]] void refuseSize(std::uint32_t size) {
  throw rosbag::BagFormatException(format("it does not hold the %u bytes that it says", size));
}

/// Not through rosbag, which does not say how much it has unpacked.
void unpackBz2(std::string_view packed, std::uint32_t size, std::vector<std::uint8_t>& bytes) {
  bz_stream stream{};
  if (BZ2_bzDecompressInit(&stream, 0, 0) != BZ_OK) throw std::bad_alloc();
  const struct End {
    bz_stream* of;
    ~End() { BZ2_bzDecompressEnd(of); }
  } end{&stream};
  stream.next_in = const_cast<char*>(packed.data());
  stream.avail_in = static_cast<unsigned>(packed.size());
  bytes = {};
  int result = BZ_OK;
  std::size_t unpacked = 0;
  while (result == BZ_OK && unpacked <= size) {
    // One more than there may be shows that there is more.
    bytes.resize(std::min(std::max(2 * unpacked, kFirstPiece), std::size_t{size} + 1));
    stream.next_out = reinterpret_cast<char*>(bytes.data() + unpacked);
    stream.avail_out = static_cast<unsigned>(bytes.size() - unpacked);
    result = BZ2_bzDecompress(&stream);
    if (result == BZ_OK && stream.avail_out > 0) break;  // it wants more than there is
    unpacked = bytes.size() - stream.avail_out;
  }
  if (result == BZ_MEM_ERROR) throw std::bad_alloc();
  if (result != BZ_OK && result != BZ_STREAM_END)
    throw rosbag::BagFormatException(format("it is damaged (error %d of bz2)", result));
  if (result != BZ_STREAM_END || unpacked != size) refuseSize(size);
  bytes.resize(size);
}

void unpackLz4(std::string_view packed, std::uint32_t size, std::vector<std::uint8_t>& bytes) {
  if (size > kMostOfLz4 * packed.size() + kFrameOfLz4) refuseSize(size);
  bytes.resize(size);
  std::string writable(packed);  // rosbag wants to
  rosbag::ChunkedFile().decompress(rosbag::compression::LZ4, bytes.data(), size,
                                   reinterpret_cast<std::uint8_t*>(writable.data()),
                                   static_cast<unsigned>(writable.size()));
}

}  // namespace

void unpackChunk(std::string_view compression, std::string_view packed, std::uint32_t size,
                 std::vector<std::uint8_t>& bytes) {
  if (compression == rosbag::COMPRESSION_BZ2)
    unpackBz2(packed, size, bytes);
  else if (compression == rosbag::COMPRESSION_LZ4)
    unpackLz4(packed, size, bytes);
  else
    throw rosbag::BagFormatException(
        format("its compression \"%s\" is not known", std::string(compression).c_str()));
}

}  // namespace raven_correction
