// SPDX-License-Identifier: BSD-3-Clause
// How a command arrives at the controller of a Raven, whatever it moves: replays of latched
// publishers, and stamps near and far from now. The rules for poses are command_gate.h.
#pragma once

#include <set>
#include <string>

namespace raven_correction {

/// One per stream of commands. Not thread-safe.
class Arrival {
 public:
  /// @param stamp_tolerance  further from now, a command acts when it arrives [s]
  /// @throws InvalidInput  negative or not finite
  explicit Arrival(double stamp_tolerance);
  /// The first message of a latched publisher may be old, and is not a command.
  bool isReplay(const std::string& publisher, bool latched);
  /// When a command acts, which never runs backwards. A stamp within stamp_tolerance of `now` is
  /// believed, so the time on the network does not count; any other, 0 included, is replaced by
  /// `now`, as by a real controller.
  /// @param now, stamp  [s]
  double actingTime(double now, double stamp) noexcept;
  /// The controller was started anew; latched publishers are the same as before.
  void reset() noexcept;

 private:
  double stamp_tolerance_;
  double last_;  // acting time of the command before [s]
  std::set<std::string> latched_publishers_;
};

}  // namespace raven_correction
