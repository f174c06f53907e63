// SPDX-License-Identifier: BSD-3-Clause
// Physics as the mean of the correction: which simulation a model carries, whether it is of the
// robot that the data are of, and the path that its way back sees. The way back through a
// simulation is simulation/inverse_arm.h; what the process learns about it is model.h.
#pragma once

#include <optional>

#include "raven_correction/correction/model.h"
#include "raven_correction/dataset/trajectory.h"

namespace raven_correction {

/// The simulation as a model carries it. Its session is as old as the last session of the data set
/// is long (sessionStarts()), and held set-points are half a command period of the data set old
/// (InverseTiming).
/// @param delay  of the model: observation behind command [s]
/// @throws InvalidInput  the simulation is of another robot than the data set: another frame, the
///         name of another robot as `arm`, or the other side; or its robot file cannot be read
Correction::Physics physicsOf(const SimulationConfig& simulation, const Dataset& dataset,
                              double delay);

/// The way back through the simulation of a model, or nothing if it has none.
/// @throws InvalidInput  its text cannot be read, or does not describe a simulation
std::optional<InverseArm> inverseArmOf(const Correction::Physics& physics);

/// The path of a motion, out of its pose and twists alone: exactly what the process knows of it.
/// Corners lie where the intervals of kPast begin, at the beginning of the window of a causal or
/// central slope, and now.
ToolPath pathOf(const Motion& motion, const MotionOptions& options) noexcept;

}  // namespace raven_correction
