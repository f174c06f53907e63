// SPDX-License-Identifier: BSD-3-Clause
// A session in the parts into which the recorder split it; which files belong together is the
// business of session_inputs.cpp.
#pragma once

#include <string>
#include <vector>

#include "raven_correction/ros/session_bag.h"

namespace raven_correction {

/// @param parts  files, in the order of their numbers
/// @throws InvalidInput  see readSessionBag()
Session readSessionParts(const std::vector<std::string>& parts);

}  // namespace raven_correction
