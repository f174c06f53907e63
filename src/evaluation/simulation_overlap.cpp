// SPDX-License-Identifier: BSD-3-Clause
#include "raven_correction/evaluation/simulation_overlap.h"

#include <algorithm>
#include <cmath>

namespace raven_correction {
namespace {

constexpr double kSameStart = 1e-3;  // [s]

}  // namespace

SimulationOverlap overlapOf(const SimulationConfig& simulation, const Dataset& judged_on) {
  SimulationOverlap overlap;
  overlap.known = !simulation.fitted_to.empty() || simulation.effects.empty();
  overlap.of = judged_on.trajectories.size();
  for (const Trajectory& trajectory : judged_on.trajectories)
    overlap.seen += std::any_of(
        simulation.fitted_to.begin(), simulation.fitted_to.end(),
        [&](double start) { return std::abs(start - trajectory.start()) < kSameStart; });
  return overlap;
}

}  // namespace raven_correction
