// SPDX-License-Identifier: BSD-3-Clause
// Figures that say what a recording is like, to hold a simulated one against a measured one:
// errors, delay, dirt, timing. What a correction makes of it is the room `evaluation`.
#pragma once

#include <string>
#include <vector>

#include "raven_correction/dataset/trajectory.h"

namespace raven_correction {

/// Position errors are those of the observation against the command of `delay` earlier.
struct SessionStatistics {
  double delay = 0.0;                  ///< by estimateDelay() [s]
  double raw_position_norm = 0.0;      ///< norm of the mean absolute errors per axis [m]
  double raw_position_median = 0.0;    ///< [m]
  double raw_angle_median = 0.0;       ///< [rad]
  double rigid_position_median = 0.0;  ///< after the rigid fit to the nearest 80 % [m]
  double rigid_position_p95 = 0.0;     ///< [m]
  double angle_median = 0.0;           ///< after the best fixed rotations of base and tool [rad]
  double angle_p95 = 0.0;              ///< [rad]
  double wrong_share = 0.0;            ///< of orientations more than 60 deg off after that [-]
  double repeated_share = 0.0;         ///< of observations that repeat the one before [-]
  double gap_share = 0.0;              ///< of observation intervals above 50 ms [-]
  double period_median = 0.0;          ///< of observations [s]
  double period_p95 = 0.0;             ///< [s]
  double jump_share = 0.0;             ///< of observation steps above 5 mm [-]
  double encoder_median = 0.0;         ///< encoder FK against the command of the same instant [m]
  std::size_t pairs = 0;               ///< of command and observation
};

/// @throws InvalidInput  no trajectory has both commands and observations
SessionStatistics sessionStatistics(const Dataset& dataset);

/// What is left of one pair of command and observation after the two best fixed rotations.
struct PairResidual {
  std::size_t trajectory = 0;  ///< index into the data set
  Pose command;                ///< at the stamp of the observation minus the delay
  double speed = 0.0;          ///< of the command since the pair before [m/s]; 0 for the first
  double position = 0.0;       ///< after the rigid fit to the nearest 80 % [m]
  double angle = 0.0;          ///< after the fixed rotations of base and tool [rad]
};
/// The residuals that sessionStatistics() looks at, one by one.
/// @param delay  of the observation behind the command [s]
/// @throws InvalidInput  as sessionStatistics()
std::vector<PairResidual> pairResiduals(const Dataset& dataset, double delay);

/// Intervals between successive observations of the same trajectory, repeated ones left out [s].
std::vector<double> observationIntervals(const Dataset& dataset);

struct StatisticsRow {
  std::string quantity;
  double measured = 0.0;
  double simulated = 0.0;
  std::string unit;
};
/// The same figures side by side, in mm, deg, s and %.
std::vector<StatisticsRow> compareStatistics(const SessionStatistics& measured,
                                             const SessionStatistics& simulated);

}  // namespace raven_correction
