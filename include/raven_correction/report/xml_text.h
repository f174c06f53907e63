// SPDX-License-Identifier: BSD-3-Clause
// Text as XML and HTML may hold it. Everything that comes from a user or from data goes through
// here; what is built of it is svg and html in this room.
#pragma once

#include <string>

namespace raven_correction {

/// & < > " ' become entities; control characters but line feed and tab, and bytes that are not
/// UTF-8, become U+FFFD, so that any text can stand in any element or attribute.
std::string xmlText(const std::string& text);

}  // namespace raven_correction
