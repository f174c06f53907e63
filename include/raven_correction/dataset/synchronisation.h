// SPDX-License-Identifier: BSD-3-Clause
// Pairs of command and observation: samples that cannot be real leave their stream, and the command
// is interpolated to the instants of the observations, a delay earlier. How large the delay is is
// delay.h; which pairs are worth learning from is the room `cleaning`.
#pragma once

#include <array>
#include <cstddef>
#include <limits>
#include <string>
#include <vector>

#include "raven_correction/dataset/trajectory.h"

namespace raven_correction {

/// What became of one sample of an observation stream. Everything but kKept is a rejection; the
/// first reason that applies is the one that counts.
enum class Fate {
  kKept,
  kNotFinite,           ///< a coordinate is nan or infinite
  kNotUnit,             ///< quaternion not of unit length
  kRepeated,            ///< same stamp or same pose as the sample before: a frozen frame
  kNoCommand,           ///< no command at that instant: before the first or after the last
  kCommandGap,          ///< the commands around the instant are further apart than max_gap
  kLongStep,            ///< the observation before it is too long ago to take a velocity from
  kRotationWindow,      ///< orientation in which the markers cannot be visible
  kWorkspace,           ///< outside the workspace box
  kSpeed,               ///< faster than the robot can move
  kAngularSpeed,        ///< turns faster than the robot can
  kLeastMedian,         ///< outlier of the least-median-of-squares rigid model
  kTrajectoryRejected,  ///< too large a share of its trajectory was rejected
  kCount                ///< number of fates, not a fate
};
const char* fateName(Fate fate) noexcept;  ///< "kept", "not_finite", ...

/// Samples per fate; the sum is the number of observation samples looked at.
struct FateCounts {
  std::array<std::size_t, static_cast<std::size_t>(Fate::kCount)> count{};
  std::size_t& operator[](Fate fate) { return count[static_cast<std::size_t>(fate)]; }
  std::size_t operator[](Fate fate) const { return count[static_cast<std::size_t>(fate)]; }
  std::size_t total() const;
  FateCounts& operator+=(const FateCounts& other);
};

/// A pose stream without the samples that cannot be real, stamps strictly increasing.
struct ScreenedStream {
  PoseStream samples;
  /// Index into `samples` that each original sample is, or repeats; npos where it cannot be real.
  std::vector<std::size_t> index_of;
  std::vector<Fate> fate;    ///< of each original sample: kKept, kNotFinite, kNotUnit, kRepeated
  std::size_t identity = 0;  ///< samples left out because they were identity poses
  static constexpr std::size_t npos = std::numeric_limits<std::size_t>::max();
};

/// Observations: drops samples that are not finite or not unit and those that repeat the one
/// before. A sample whose stamp goes back is dropped as kRepeated.
ScreenedStream screenObservations(const PoseStream& stream);
/// Commands: drops samples that are not finite, not unit or the identity; of equal stamps the last
/// one stays, because it is the one that the robot follows.
ScreenedStream screenCommands(const PoseStream& stream);

struct SynchronisationOptions {
  double delay = 0.0;            ///< observation behind command [s]
  double max_gap = 0.0;          ///< longest interval of commands bridged [s]; 0: from the period
  double max_gap_periods = 5.0;  ///< max_gap = this times the median period of the commands [-]
};

struct CommandPair {
  std::size_t sample = 0;  ///< index into the screened observations
  Pose command;            ///< interpolated at (stamp of the sample - delay)
};

/// One trajectory after synchronisation.
struct SynchronisedTrajectory {
  std::string id;
  ScreenedStream observations;
  std::vector<CommandPair> pairs;  ///< by increasing sample
  FateCounts fates;                ///< of all original observations; kept = number of pairs
  std::size_t identity_commands = 0;
};

/// The max_gap in force: options.max_gap, or the multiple of the median command period of the whole
/// data set [s].
double commandGapLimit(const Dataset& dataset, const SynchronisationOptions& options);

/// Every trajectory of the data set, in its order. An observation at t is paired with the command
/// at t - delay (position linearly, orientation on the sphere).
/// @throws InvalidInput  no trajectory has both commands and observations, or an option is negative
///         or not finite
std::vector<SynchronisedTrajectory> synchronise(const Dataset& dataset,
                                                const SynchronisationOptions& options);

}  // namespace raven_correction
