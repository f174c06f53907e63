// SPDX-License-Identifier: BSD-3-Clause
// A session in the parts into which the recorder split it; which files belong together is the
// business of session_inputs.cpp.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "raven_correction/ros/session_bag.h"

namespace raven_correction {

/// Part i of n of what `progress` tells of; `progress` has to live as long as what is returned.
ShareRead partOf(const ShareRead& progress, std::size_t i, std::size_t n);

/// @param parts  files, in the order of their numbers
/// @throws InvalidInput  see readSessionBag()
Session readSessionParts(const std::vector<std::string>& parts, const ShareRead& progress);

}  // namespace raven_correction
