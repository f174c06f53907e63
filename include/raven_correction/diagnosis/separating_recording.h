// SPDX-License-Identifier: BSD-3-Clause
// Advice on what to record next, where a recording cannot tell two causes apart. Which those are is
// selection.h.
#pragma once

#include <string>

namespace raven_correction {

/// What would separate two effects of the catalogue, in either order; general advice where no
/// better is known. Words for people, without a full stop.
std::string separatingRecording(const std::string& effect, const std::string& other);

}  // namespace raven_correction
