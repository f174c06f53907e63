// SPDX-License-Identifier: BSD-3-Clause
// Whether a simulation can be judged on trajectories: it cannot on those that it was fitted to. How
// good it is on them is fidelity.h and learning_curve.h.
#pragma once

#include <cstddef>

#include "raven_correction/dataset/trajectory.h"
#include "raven_correction/simulation/simulation_config.h"

namespace raven_correction {

struct SimulationOverlap {
  bool known = false;    ///< the simulation says what it was fitted to, or has nothing to fit
  std::size_t seen = 0;  ///< of the trajectories, those that it was fitted to
  std::size_t of = 0;    ///< all of them
  bool independent() const noexcept { return known && seen == 0; }
};

/// Compares SimulationConfig::fitted_to with the start stamps of the trajectories, to a
/// millisecond: no two motions of one robot start within one, and files round differently.
SimulationOverlap overlapOf(const SimulationConfig& simulation, const Dataset& judged_on);

}  // namespace raven_correction
