// SPDX-License-Identifier: BSD-3-Clause
// How a command arrives at the controller of a Raven, whatever it moves: stamps near and far from
// now. Replays of latched publishers are latched_replay.h, the rules for poses command_gate.h.
#pragma once

namespace raven_correction {

/// One per stream of commands. Not thread-safe.
class Arrival {
 public:
  /// @param stamp_tolerance  further from now, a command acts when it arrives [s]
  /// @throws InvalidInput  negative or not finite
  explicit Arrival(double stamp_tolerance);
  /// When a command acts, which never runs backwards. A stamp within stamp_tolerance of `now` is
  /// believed, so the time on the network does not count; any other, 0 included, is replaced by
  /// `now`, as by a real controller.
  /// @param now, stamp  [s]
  double actingTime(double now, double stamp) noexcept;
  /// The controller was started anew.
  void reset() noexcept;

 private:
  double stamp_tolerance_;
  double last_;  // acting time of the command before [s]
};

}  // namespace raven_correction
