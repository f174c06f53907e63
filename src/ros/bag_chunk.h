// SPDX-License-Identifier: BSD-3-Clause
// What a compressed chunk of a bag holds, without trust in the size that it claims to have.
#pragma once

#include <cstdint>
#include <string_view>
#include <vector>

namespace raven_correction {

/// @param compression  as the chunk names it: "bz2" or "lz4"
/// @param size  that the chunk claims to have, unpacked. Whatever it claims, no more memory is
/// taken
///              than three times what is there (bz2), or 257 times the packed bytes (lz4)
/// @param bytes  resized to `size`
/// @throws rosbag::BagException  unknown compression, damaged, or of another size
/// @throws std::bad_alloc
void unpackChunk(std::string_view compression, std::string_view packed, std::uint32_t size,
                 std::vector<std::uint8_t>& bytes);

}  // namespace raven_correction
