// SPDX-License-Identifier: BSD-3-Clause
#include "raven_correction/ros/trajectory_windows.h"

namespace raven_correction {

void TrajectoryWindows::start(const std::string& trajectory, double stamp) {
  if (!windows_.empty() && windows_.back().open) {
    windows_.back().end = stamp;
    windows_.back().open = false;
  }
  windows_.push_back({trajectory, stamp});
  if (windows_.size() > kRemembered) windows_.pop_front();
}

bool TrajectoryWindows::end(const std::string& trajectory, double stamp) {
  if (windows_.empty() || !windows_.back().open || windows_.back().trajectory != trajectory)
    return false;
  windows_.back().end = stamp;
  windows_.back().open = false;
  return true;
}

std::string TrajectoryWindows::at(double instant) const {
  for (auto window = windows_.rbegin(); window != windows_.rend(); ++window)
    if (instant >= window->start && instant <= window->end + kAfterEnd) return window->trajectory;
  return {};
}

}  // namespace raven_correction
