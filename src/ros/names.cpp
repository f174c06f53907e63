// SPDX-License-Identifier: BSD-3-Clause
#include "raven_correction/ros/names.h"

#include <cstdlib>

namespace raven_correction {

std::string withoutSlash(const std::string& name) {
  return !name.empty() && name.front() == '/' ? name.substr(1) : name;
}

bool sameName(std::string_view a, std::string_view b) noexcept {
  if (!a.empty() && a.front() == '/') a.remove_prefix(1);
  if (!b.empty() && b.front() == '/') b.remove_prefix(1);
  return a == b;
}

std::string expandHome(const std::string& path) {
  const char* const home = std::getenv("HOME");
  if (home == nullptr) return path;
  for (const std::string prefix : {"~", "$HOME"})
    if (path == prefix || path.compare(0, prefix.size() + 1, prefix + "/") == 0)
      return home + path.substr(prefix.size());
  return path;
}

}  // namespace raven_correction
