// SPDX-License-Identifier: BSD-3-Clause
// What the code under test says of bad input.
#pragma once

#include <string>

#include "raven_correction/error.h"

namespace raven_correction {

/// The text of the InvalidInput that is thrown; empty if none is.
template <typename Action>
std::string complaint(const Action& action) {
  try {
    action();
  } catch (const InvalidInput& error) {
    return error.what();
  }
  return "";
}

}  // namespace raven_correction
