// SPDX-License-Identifier: BSD-3-Clause
// Whether the topics that streams are expected on are there, by name and type alone, live or in a
// bag. What comes on them is stream_check.h.
#pragma once

#include <string>
#include <vector>

#include "raven_correction/dataset/stream_finding.h"

namespace raven_correction {

/// A topic, as it is published or as it is expected.
struct TopicType {
  std::string topic;  ///< resolved
  std::string type;   ///< datatype, e.g. "geometry_msgs/PoseStamped"; empty: any
};

/// Expected topics that nobody publishes, with what is there instead (topics of the same type, and
/// of a similar name), and those that are published with another type.
std::vector<StreamFinding> checkTopics(const std::vector<TopicType>& expected,
                                       const std::vector<TopicType>& published);

}  // namespace raven_correction
