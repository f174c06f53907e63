// SPDX-License-Identifier: BSD-3-Clause
#include "raven_correction/ros/bag_file.h"

#include <filesystem>

#include "bag_structure.h"
#include "raven_correction/error.h"

namespace raven_correction {

namespace fs = std::filesystem;

rosbag::Bag openBagFile(const std::string& file, BagParts parts) {
  checkBagStructure(file, parts);
  return rosbag::Bag(file, rosbag::bagmode::Read);
}

void writeBagFile(const std::string& file, bool overwrite,
                  const std::function<void(rosbag::Bag&)>& write) {
  if (!overwrite && fs::exists(file))
    throw InvalidInput(
        format("%s: exists; nothing was written, choose another name", file.c_str()));
  const std::string part = file + ".part";
  try {
    const fs::path folder = fs::path(file).parent_path();
    if (!folder.empty()) fs::create_directories(folder);
    rosbag::Bag bag(part, rosbag::bagmode::Write);
    write(bag);
    bag.close();
    fs::rename(part, file);
  } catch (const std::exception& error) {
    std::error_code ignored;
    fs::remove(part, ignored);
    throw InvalidInput(format("%s: cannot be written: %s", file.c_str(), error.what()));
  }
}

}  // namespace raven_correction
