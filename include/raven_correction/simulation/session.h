// SPDX-License-Identifier: BSD-3-Clause
// Whole recordings from the simulation, in the form in which measured ones are read: unsynchronised
// streams of commands, encoders and motion capture, trajectory by trajectory.
#pragma once

#include <cstdint>

#include "raven_correction/dataset/trajectory.h"
#include "raven_correction/simulation/simulation_config.h"

namespace raven_correction {

/// A debridement session.
/// @param trajectories  how many, > 0
/// @throws InvalidInput  a bad configuration (see DebridementMotion)
Dataset simulateSession(const SimulationConfig& config, int trajectories, std::uint64_t seed);

/// What the simulated robot would have done under these commands. Trajectories keep their ids and
/// stamps; each starts at rest at its first command, the session's time runs on between them.
/// Commands that are not poses (not finite, identity) are kept in the data, and not executed.
/// @param measured  only its command streams are read
/// @throws InvalidInput  no trajectory, or one without a command that the robot can reach
Dataset simulateCommands(const SimulationConfig& config, const Dataset& measured,
                         std::uint64_t seed);

}  // namespace raven_correction
