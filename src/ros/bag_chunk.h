// SPDX-License-Identifier: BSD-3-Clause
// What a compressed chunk of a bag holds, without trust in the size that it claims to have.
#pragma once

#include <cstdint>
#include <string_view>
#include <vector>

namespace raven_correction {

/// @param compression  as the chunk names it: "bz2" or "lz4"
/// @param size  that the chunk claims to have, unpacked; no more memory is taken than what is there
///              to be unpacked needs
/// @param bytes  resized to `size`
/// @throws rosbag::BagException  unknown compression, damaged, or of another size
void unpackChunk(std::string_view compression, std::string_view packed, std::uint32_t size,
                 std::vector<std::uint8_t>& bytes);

}  // namespace raven_correction
