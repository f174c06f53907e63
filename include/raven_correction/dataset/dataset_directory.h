// SPDX-License-Identifier: BSD-3-Clause
// Data set directories: dataset.yaml with one CSV file per stream. The same content as a bag, for
// people and other programs. Plain tables of numbers are csv.h.
#pragma once

#include <string>
#include <vector>

#include "raven_correction/dataset/trajectory.h"

namespace raven_correction {

/// Reads DIR/dataset.yaml and the streams it names:
///
///   name, description, frame, arm: text
///   streams: {commands|observations|encoders: {file: X.csv, kind: pose|joint}}
///   joints: [{name: X, unit: rad|m}]   (optional; for joint streams)
///
/// Pose streams have the columns trajectory,stamp,x,y,z,qx,qy,qz,qw (s, m, unit quaternion), joint
/// streams trajectory,stamp,<joints...> (s, rad or m). Quaternions are normalised.
/// @return trajectories in order of start time
/// @throws InvalidInput  a file is missing or has other columns; a value is not finite, a
/// quaternion
///         is not of unit length within 1e-3, a stamp goes back within its trajectory, a trajectory
///         is interrupted by another (the text has file, line and remedy)
Dataset readDatasetDirectory(const std::string& directory);

/// Writes what readDatasetDirectory() reads. Numbers have 17 significant digits, stamps 9 decimals.
/// @throws InvalidInput  the directory exists and is not empty, or cannot be written
void writeDatasetDirectory(const Dataset& dataset, const std::string& directory);

/// One pose stream of a CSV file, cut into trajectories, in the order of the file.
struct NamedPoseStream {
  std::string trajectory;
  PoseStream samples;
  std::vector<std::size_t> lines;  ///< of the samples in the file, counted from 1
};

enum class PoseChecks {
  kStrict,  ///< as readDatasetDirectory() says
  kNone,    ///< any numbers pass, also nan, in any order: for programs that answer line by line
};

/// @throws InvalidInput  as readDatasetDirectory(), as far as `checks` asks for it
std::vector<NamedPoseStream> readPoseCsv(const std::string& file, PoseChecks checks);

}  // namespace raven_correction
