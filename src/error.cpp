// SPDX-License-Identifier: BSD-3-Clause
#include "raven_correction/error.h"

#include <cstdarg>
#include <cstdio>
#include <vector>

namespace raven_correction {

std::string format(const char* pattern, ...) {
  va_list arguments;
  va_start(arguments, pattern);
  va_list again;
  va_copy(again, arguments);
  const int length = std::vsnprintf(nullptr, 0, pattern, arguments);
  va_end(arguments);
  std::vector<char> text(static_cast<std::size_t>(length > 0 ? length : 0) + 1);
  std::vsnprintf(text.data(), text.size(), pattern, again);
  va_end(again);
  return std::string(text.data());
}

}  // namespace raven_correction
