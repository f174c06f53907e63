// SPDX-License-Identifier: BSD-3-Clause
// Reads a kinematic chain from YAML (config/robots/*.yaml; the files say what each key means).
#pragma once

#include <string>

#include "raven_correction/robot/kinematic_chain.h"

namespace raven_correction {

/// @throws InvalidInput  no such file, not YAML, or any missing key, unknown key, wrong type or
///                       value out of range: one text that lists them all with their place
KinematicChain loadKinematicChain(const std::string& path);
/// The same from the text of such a file; `name` stands for the file in messages.
KinematicChain kinematicChainFromText(const std::string& text, const std::string& name);

}  // namespace raven_correction
