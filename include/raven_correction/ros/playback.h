// SPDX-License-Identifier: BSD-3-Clause
// When each command of a planned motion is sent, on a clock that may stall or run late, and how a
// motion comes to rest when it is stopped in its middle.
#pragma once

#include <optional>

#include "raven_correction/geometry/stream.h"

namespace raven_correction {

/// From one pose to another along a straight line and the shorter arc, with the minimum-jerk
/// profile s(u) = 10 u^3 - 15 u^4 + 6 u^5. Its duration is the shortest for which the peak values
/// 1.875 length / T, 1.875 angle / T and 5.7735 length / T^2 are within the limits.
/// @param speed, angular_speed, acceleration  limits, > 0 [m/s, rad/s, m/s^2]
/// @param period  between two commands, > 0 [s]
/// @return first stamp 0 and pose `from`, last pose `to`; at least two samples
/// @throws InvalidInput  a limit or the period is not positive, or a pose is not finite
/// Source: Flash, Hogan 1985, doi:10.1523/JNEUROSCI.05-07-01688.1985
PoseStream smoothMove(const Pose& from, const Pose& to, double speed, double angular_speed,
                      double acceleration, double period);

/// Not thread-safe.
class Playback {
 public:
  /// @param motion    commands; only differences of their stamps count
  /// @param start     when the first one is due [s]
  /// @param max_late  a command that is sent later than this after it was due delays all that
  ///                  follow, so that the tool never moves faster to catch up [s]
  /// @throws InvalidInput  empty motion, stamps that decrease, or max_late < 0
  Playback(PoseStream motion, double start, double max_late);

  bool finished() const noexcept { return finished_; }
  /// When the next command is due [s].
  double due() const noexcept { return due_; }
  /// The next command, to be sent now; its stamp is due(). Nothing if it is not due yet or the
  /// motion is finished.
  std::optional<StampedPose> next(double now);
  /// From now on the motion slows down evenly along its path and ends, at rest, this much later.
  /// @param duration  >= 0 [s]
  void stop(double duration);
  bool stopping() const noexcept { return stop_duration_ >= 0.0; }

 private:
  PoseStream motion_;
  std::size_t index_ = 0;  // of the next command, until a stop
  double max_late_;
  double due_;
  bool finished_ = false;
  double stop_duration_ = -1.0;  // negative: not stopping
  double stop_elapsed_ = 0.0;
  double stop_from_ = 0.0;  // stamp within the motion at which the stop began
  double period_ = 0.0;     // of commands while stopping
};

}  // namespace raven_correction
