// SPDX-License-Identifier: BSD-3-Clause
// Names as users and drivers write them, in the form in which they are compared and opened. The
// names of topics are topics.h.
#pragma once

#include <string>
#include <string_view>

namespace raven_correction {

/// "/0_link" and "0_link" are the same frame, "/servo_cp" and "servo_cp" the same topic of a bag.
std::string withoutSlash(const std::string& name);
/// withoutSlash(a) == withoutSlash(b), without allocation.
bool sameName(std::string_view a, std::string_view b) noexcept;

/// "~", "~/x", "$HOME" and "$HOME/x" with the home directory in its place; all else, and everything
/// where HOME is not set, as it is.
std::string expandHome(const std::string& path);

}  // namespace raven_correction
