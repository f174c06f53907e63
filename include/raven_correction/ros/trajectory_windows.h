// SPDX-License-Identifier: BSD-3-Clause
// Which trajectory an instant belongs to, from the START and END events heard so far: the live form
// of the rule that cuts a bag (doc/bags.md).
#pragma once

#include <cstddef>
#include <deque>
#include <limits>
#include <string>

namespace raven_correction {

class TrajectoryWindows {
 public:
  /// What is seen comes later than what is commanded: a window stays open this long after its END
  /// for observations [s].
  static constexpr double kAfterEnd = 0.5;

  /// A START ends the trajectory before it, if that is still open.
  void start(const std::string& trajectory, double stamp);
  /// @return true if it completes a trajectory; an END without its START changes nothing
  bool end(const std::string& trajectory, double stamp);
  void clear() { windows_.clear(); }

  /// Identifier of the trajectory of an observation; of overlapping ones the later. Empty between
  /// trajectories.
  /// @param instant  [s]
  std::string at(double instant) const;

 private:
  struct Window {
    std::string trajectory;
    double start = 0.0;                                    // [s]
    double end = std::numeric_limits<double>::infinity();  // [s]
    bool open = true;
  };
  static constexpr std::size_t kRemembered = 16;
  std::deque<Window> windows_;  // in the order of their START
};

}  // namespace raven_correction
