// SPDX-License-Identifier: BSD-3-Clause
// How near the instruments of two arms come to one another. What an instrument hides from a camera
// is camera_rig.h.
#pragma once

#include "raven_correction/simulation/camera_rig.h"

namespace raven_correction {

/// Distance between the surfaces of two straight pieces with round ends [m]; negative where they
/// overlap.
/// Source: Ericson 2005, Real-Time Collision Detection, section 5.1.9
double clearance(const Obstacle& a, const Obstacle& b) noexcept;

}  // namespace raven_correction
