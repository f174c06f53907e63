// SPDX-License-Identifier: BSD-3-Clause
// The topic by which a simulator says that a jaw closed or opened, and where the tool truly is.
// Topics that real arms have, too, are topics.h.
#pragma once

namespace raven_correction {

constexpr char kJawEventTopic[] = "jaw/event";  ///< JawEvent, in the namespace of the arm

}  // namespace raven_correction
