// SPDX-License-Identifier: BSD-3-Clause
// Pairs of command and observation while they arrive: the rule of dataset/synchronisation.h, told
// one sample at a time. Knows no message and no clock; frames are the business of the caller.
#pragma once

#include <cstddef>
#include <deque>
#include <optional>
#include <vector>

#include "raven_correction/dataset/synchronisation.h"
#include "raven_correction/geometry/stream.h"

namespace raven_correction {

struct LiveSynchroniserOptions {
  double max_gap = 0.0;          ///< longest interval of commands bridged [s]; 0: from the period
  double max_gap_periods = 5.0;  ///< max_gap = this times the median of the latest periods [-]
  /// How long an observation waits for a command that is not earlier, and how far back commands
  /// are kept for observations that arrive late [s]. A stamp further back than this is a restart
  /// (a bag that loops, a planner's clock that was set), and both streams begin anew.
  double horizon = 5.0;
};

struct LivePair {
  double stamp = 0.0;  ///< instant of the observation [s]
  Pose command;        ///< interpolated at that instant
  Pose observation;    ///< as it came
};

/// An observation becomes a pair once a command with an equal or later stamp is there: position
/// linearly, orientation on the sphere, nothing across a gap, nothing extrapolated. The result
/// does not depend on the order in which the two streams arrive, and is that of synchronise() with
/// delay 0 as long as no two commands share a stamp (there the last one counts, here perhaps the
/// one before). Not thread-safe.
class LiveSynchroniser {
 public:
  /// @throws InvalidInput  an option is negative, zero where it must not be, or not finite
  explicit LiveSynchroniser(const LiveSynchroniserOptions& options);

  /// Both streams in one frame, each by increasing stamp; samples that cannot be real, repeat the
  /// one before or carry the stamp 0 ("not valid") are left out.
  /// @return the pairs that this sample completes, by increasing stamp
  std::vector<LivePair> addCommand(const StampedPose& command);
  std::vector<LivePair> addObservation(const StampedPose& observation);

  void clear();  ///< forgets all samples, keeps the counts

  /// What became of the observations so far; those that still wait are not in it.
  const FateCounts& fates() const { return fates_; }
  std::size_t waiting() const { return waiting_.size(); }  ///< observations without a fate yet
  std::size_t kept() const { return commands_.size(); }    ///< commands remembered
  std::size_t restarts() const { return restarts_; }       ///< times a stream jumped back
  double gapLimit();                                       ///< the max_gap in force [s]

 private:
  std::vector<LivePair> resolve();
  void trimCommands();
  void restart();

  LiveSynchroniserOptions options_;
  PoseStream commands_;              // strictly increasing stamps
  std::deque<StampedPose> waiting_;  // strictly increasing stamps
  std::optional<StampedPose> last_observation_;
  std::deque<double> periods_;  // of the latest commands [s]
  double automatic_gap_ = 0.0;  // from periods_ [s]
  bool periods_changed_ = false;
  FateCounts fates_;
  std::size_t restarts_ = 0;
};

}  // namespace raven_correction
