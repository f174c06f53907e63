// SPDX-License-Identifier: BSD-3-Clause
#include "raven_correction/ros/latched_replay.h"

#include <algorithm>

namespace raven_correction {

bool LatchedReplay::isReplay(const boost::shared_ptr<ros::M_string>& connection) {
  if (connection == nullptr) return false;
  const auto latching = connection->find("latching");
  if (latching == connection->end() || latching->second != "1") return false;
  for (const auto& seen : seen_)
    if (seen.lock() == connection) return false;
  seen_.erase(
      std::remove_if(seen_.begin(), seen_.end(), [](const auto& seen) { return seen.expired(); }),
      seen_.end());
  seen_.push_back(connection);
  return true;
}

}  // namespace raven_correction
