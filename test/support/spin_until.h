// SPDX-License-Identifier: BSD-3-Clause
// Waits for what the callbacks of this thread's node write.
#pragma once

#include <ros/ros.h>

#include "support/wait_for.h"

namespace raven_correction {

/// Takes messages and asks until the condition holds.
/// @return false if it does not hold within `limit` seconds
template <typename Condition>
bool spinUntil(Condition condition, double limit) {
  return waitFor(
      [&] {
        ros::spinOnce();
        return condition();
      },
      limit);
}

}  // namespace raven_correction
