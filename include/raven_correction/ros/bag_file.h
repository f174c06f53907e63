// SPDX-License-Identifier: BSD-3-Clause
// Bags that may be damaged, and a bag that is written at once and is there complete or not at all
// (models, imported sessions). A recording, which grows for minutes, is session_writer.h.
#pragma once

#include <rosbag/bag.h>

#include <functional>
#include <string>

namespace raven_correction {

/// What is going to be read of a bag.
enum class BagParts {
  kTopics,  ///< connections only: nothing is unpacked
  kAll
};

/// A bag to read, of which no damage makes rosbag read beyond its memory (bag_structure.h).
/// @param parts  nothing else may be read: only that is looked at
/// @throws rosbag::BagException  it cannot be read, or is damaged, and where
rosbag::Bag openBagFile(const std::string& file, BagParts parts = BagParts::kAll);

/// Writes FILE.part and renames it when it is complete; folders are created as needed.
/// @param write  fills the open bag; what it throws becomes the reason of the refusal
/// @throws InvalidInput  the file exists and may not be overwritten, or it cannot be written; a
///         file that was there stays as it was
void writeBagFile(const std::string& file, bool overwrite,
                  const std::function<void(rosbag::Bag&)>& write);

}  // namespace raven_correction
