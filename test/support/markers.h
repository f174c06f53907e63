// SPDX-License-Identifier: BSD-3-Clause
// Markers for rviz, sorted so that a test can look at one kind.
#pragma once

#include <visualization_msgs/MarkerArray.h>

#include <map>
#include <string>
#include <vector>

namespace raven_correction {

/// Markers of each namespace, in their order.
inline std::map<std::string, std::vector<visualization_msgs::Marker>> byNamespace(
    const visualization_msgs::MarkerArray& array) {
  std::map<std::string, std::vector<visualization_msgs::Marker>> sorted;
  for (const visualization_msgs::Marker& marker : array.markers)
    sorted[marker.ns].push_back(marker);
  return sorted;
}

}  // namespace raven_correction
