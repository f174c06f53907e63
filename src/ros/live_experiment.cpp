// SPDX-License-Identifier: BSD-3-Clause
#include "raven_correction/ros/live_experiment.h"

#include <cstdlib>
#include <filesystem>

#include "raven_correction/error.h"

namespace raven_correction {

namespace fs = std::filesystem;

std::string experimentFolder(const std::string& experiment, const std::string& output) {
  if (output.empty()) {
    std::string name = fs::temp_directory_path() / ("raven_correction_" + experiment + "_XXXXXX");
    if (mkdtemp(name.data()) == nullptr)
      throw InvalidInput(format("%s: cannot be made; set --output", name.c_str()));
    return name;
  }
  fs::create_directories(output);
  if (!fs::is_empty(output))
    throw InvalidInput(
        format("%s: is not empty; nothing was written, choose another folder", output.c_str()));
  return output;
}

}  // namespace raven_correction
