// SPDX-License-Identifier: BSD-3-Clause
// Where in the workspace a model has learnt, where the robot was sent without anything that could
// be learnt from, and where to record more. What was rejected, and why, is the room `cleaning`.
#pragma once

#include <string>
#include <vector>

#include "raven_correction/correction/training.h"

namespace raven_correction {

/// One cube of the workspace, in the frame of the commands.
struct CoverageCell {
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();  ///< [m]
  std::size_t commands = 0;      ///< of observations (at their delay) that lie in it
  std::size_t kept = 0;          ///< of them, those that were learnt from
  std::size_t trajectories = 0;  ///< that those belong to
};

struct WorkspaceCoverage {
  double cell = 0.02;                     ///< edge of a cube [m]
  std::vector<CoverageCell> cells;        ///< with at least one command, most commands first
  std::size_t covered = 0;                ///< cells with enough to learn from
  std::vector<CoverageCell> record_more;  ///< sent there, but hardly learnt from; at most five
  std::vector<Pose> kept;                 ///< commands that were learnt from
  std::vector<Pose> rejected;             ///< those that were not
  std::vector<double> speed;              ///< of the observations learnt from [m/s]
  std::vector<double> angle;              ///< of their commands, from the mean orientation [rad]
};

/// A cell counts as covered with ten samples of two trajectories: fewer, and what is learnt there
/// is one motion's own error.
/// @param delay  of the trained model [s]
/// @throws InvalidInput  see makePairs()
WorkspaceCoverage workspaceCoverage(const Dataset& dataset, const TrainingConfig& config,
                                    double delay, double cell = 0.02);

}  // namespace raven_correction
