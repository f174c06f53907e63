// SPDX-License-Identifier: BSD-3-Clause
// How like a measured session a simulated one is: the simulation is driven with the measured
// commands, and both are described by the same figures. The figures of one session alone are
// simulation/session_statistics.h, the ladder of methods is table_one.h.
#pragma once

#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "raven_correction/correction/training.h"
#include "raven_correction/dataset/split.h"
#include "raven_correction/evaluation/simulation_overlap.h"
#include "raven_correction/simulation/session_statistics.h"
#include "raven_correction/simulation/simulation_config.h"

namespace raven_correction {

struct FidelityProblem {
  SimulationConfig simulation;
  TrainingConfig training;  ///< of the cleaning rules and of the ladder
  /// Figures come from the trajectories that this picks; a simulation is fitted to the others, and
  /// the ladder trains on them.
  HoldOut hold_out;
  std::uint64_t seed = 1;  ///< of the simulated motion capture and of the intervals
  int resamples = 1000;    ///< of the bootstrap over trajectories
};

/// Norm of the mean absolute errors of one method of Table I, clean test set, with the interval
/// that holds 95 % of resampled trajectories. [m or rad]
struct LadderValue {
  double value = 0.0;
  double lower = 0.0;
  double upper = 0.0;
};
struct LadderStep {
  std::string method;  ///< methodName()
  LadderValue measured_position, simulated_position;
  LadderValue measured_angle, simulated_angle;
};

/// What the simulation of a session is required to keep.
struct FidelityCriterion {
  std::string name;
  double value = 0.0;  ///< simulated against measured: a ratio minus 1, or a difference
  double limit = 0.0;  ///< largest |value|
  std::string unit;
  bool met() const { return std::abs(value) <= limit; }
};

struct FidelityResult {
  std::vector<StatisticsRow> rows;  ///< all figures, in mm, deg, s and %
  std::vector<LadderStep> ladder;
  std::vector<FidelityCriterion> criteria;
  std::size_t trajectories = 0;  ///< that the figures come from
  HoldOut hold_out;              ///< which those are
  SimulationOverlap overlap;     ///< whether the simulation was fitted to them
};

/// Simulates all trajectories one after the other (plays keep their history), then compares the
/// held-out ones. Two methods are ranked the other way where both sessions tell them apart and
/// disagree. The criterion takes methods with overlapping intervals for a tie; the row "paired" is
/// stricter: a tie is where the interval of the difference, on the same resamples, holds 0.
/// @throws InvalidInput  a bad simulation, too few trajectories, see train() and
/// sessionStatistics()
FidelityResult compareFidelity(const Dataset& measured, const FidelityProblem& problem,
                               const Progress& progress = {});

}  // namespace raven_correction
