// SPDX-License-Identifier: BSD-3-Clause
// Noise of a recording from one frame to the next: what no model can explain. What a residual that
// is larger depends on is dependence.h.
#pragma once

#include <Eigen/Core>

#include "raven_correction/diagnosis/recording.h"
#include "raven_correction/simulation/simulation_config.h"

namespace raven_correction {

/// Robust standard deviation of the components of every channel from frame to frame. Of three
/// consecutive frames, the middle one against the straight line between its neighbours,
///
///   away = r_1 - (b r_0 + a r_2) / (a + b),   var(away) = sigma^2 (1 + (a^2 + b^2) / (a + b)^2),
///
/// r: measured minus simulated, a and b: the two intervals; sigma is 1.4826 times the median of
/// |away| over its factor. Errors that change slowly from frame to frame do not count, so it hardly
/// matters which simulation it is. Frames are those before thinning, so that the floor does not
/// depend on how many observations are used. Costs one simulation of the recording.
/// @return one per channel of residualLayout(recording), in its order [m or rad]; NaN where no
///         motion has three frames whose intervals are alike within a factor of two
Eigen::VectorXd noiseFloor(const Recording& recording, const SimulationConfig& simulation);

}  // namespace raven_correction
