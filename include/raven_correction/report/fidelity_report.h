// SPDX-License-Identifier: BSD-3-Clause
// A simulated session beside the measured one, as text for a terminal and as JSON. The comparison
// is evaluation/fidelity.h.
#pragma once

#include <string>

#include "raven_correction/evaluation/fidelity.h"

namespace raven_correction {

/// Which trajectories the figures are of, and whether they test the simulation.
std::string fidelitySplit(const FidelityResult& result);

/// All figures side by side, the ladder of Table I with its intervals, and which requirements are
/// met. mm, deg, s, %.
std::string fidelityText(const FidelityResult& result);

/// {"rows": [{"quantity", "measured", "simulated", "unit"}], "ladder": [{"method", "measured":
/// {"position_mm": [value, lower, upper], "angle_deg": [...]}, "simulated": {...}}], "criteria":
/// [{"quantity", "value", "limit", "unit", "met"}], "trajectories", "hold_out": {"fold", "folds"}};
/// a figure that does not exist is null.
std::string fidelityJson(const FidelityResult& result);

}  // namespace raven_correction
