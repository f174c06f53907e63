// SPDX-License-Identifier: BSD-3-Clause
// What a recording is made of: trajectories, each with its unsynchronised streams. Reading and
// writing directories is dataset_directory.h, pairing the streams is synchronisation.h.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "raven_correction/geometry/stream.h"

namespace raven_correction {

/// One motion between two rests; the unit of every train/test split. Streams may be empty where
/// the recording has none; they are not synchronised with one another.
struct Trajectory {
  std::string id;           ///< unique within the data set
  PoseStream commands;      ///< poses sent to the native controller, in `base`
  PoseStream observations;  ///< poses seen by motion capture, registered into `base`
  PoseStream encoders;      ///< forward kinematics of the encoders, in `base`
  JointStream joint_commands;
  JointStream joint_observations;

  /// First stamp of the command stream, or of whichever stream there is [s]; 0 when all are empty.
  double start() const noexcept;
  /// Last stamp of all streams [s]; 0 when all are empty.
  double end() const noexcept;
};

struct Dataset {
  std::string name;
  std::string description;
  std::string frame = "base";  ///< frame of the pose streams
  std::string arm;
  /// "rad" or "m" of the joints that say so, by name; joint streams of robots without a chain.
  std::map<std::string, std::string> joint_units;
  std::string source;                    ///< path or bag it was read from, for messages
  std::vector<Trajectory> trajectories;  ///< in order of start time
};

/// Longest pause within a session [s]. After a longer one the robot has been switched off, homed
/// and registered anew: it is another robot in all that these change.
constexpr double kLongestPause = 3600.0;

/// Index of the first trajectory of every session: 0, and each that starts more than kLongestPause
/// after all before it have ended.
/// @param dataset  trajectories in order of start time
std::vector<std::size_t> sessionStarts(const Dataset& dataset);

/// Sorts by start time (stable); every reader calls it, so index i means the same everywhere.
void sortByStart(Dataset& dataset);

}  // namespace raven_correction
