// SPDX-License-Identifier: BSD-3-Clause
// Whole recordings from the simulation, in the form in which measured ones are read: unsynchronised
// streams of commands, encoders and motion capture, trajectory by trajectory.
#pragma once

#include <cstdint>
#include <vector>

#include "raven_correction/dataset/trajectory.h"
#include "raven_correction/simulation/excitation_motion.h"
#include "raven_correction/simulation/simulated_arm.h"
#include "raven_correction/simulation/simulation_config.h"

namespace raven_correction {

/// A debridement session.
/// @param trajectories  how many, > 0
/// @throws InvalidInput  a bad configuration (see DebridementMotion)
Dataset simulateSession(const SimulationConfig& config, int trajectories, std::uint64_t seed);

/// The same of several arms that work at the same time, one data set per arm. Each arm has random
/// numbers of its own: the first those of simulateSession() with this seed. Where robots share a
/// base frame, the instrument of each hides the LEDs of the others from the cameras (camera_rig.h);
/// arms do not touch one another.
std::vector<Dataset> simulateSessions(const std::vector<SimulationConfig>& configs,
                                      int trajectories, std::uint64_t seed);

/// A session made for identification: see excitation_motion.h. Ids end in joint and stroke time.
/// @throws InvalidInput  a bad configuration
Dataset simulateExcitation(const SimulationConfig& config, const ExcitationConfig& excitation,
                           std::uint64_t seed);

/// What the simulated robot would have done under these commands. Trajectories keep their ids and
/// stamps. Between two of them the arm goes to the first pose of the next and waits there, so plays
/// keep their history; it stays where it is if that is within 30 mm, because recordings that begin
/// during a motion begin little after its start.
/// Commands that are not poses (not finite, identity) are kept in the data, and not executed.
/// @param measured  only its command streams are read
/// @throws InvalidInput  no trajectory, or one without a command that the robot can reach
Dataset simulateCommands(const SimulationConfig& config, const Dataset& measured,
                         std::uint64_t seed);

struct ReplaySample {
  Pose tool;           ///< as motion capture would see it without noise, X_base_tool
  Pose measured;       ///< forward kinematics of the encoders, X_base_tool
  JointVector joints;  ///< joint side
  JointVector motors;  ///< as the encoders report them, in joint units
};

/// Noise-free poses under the commands of one trajectory at given instants: what a fit compares
/// with measurements. The arm is reset to rest at the first command.
/// @param instants  never decreasing [s]
/// @throws InvalidInput  no command that is a pose, or the first one cannot be reached
std::vector<ReplaySample> replay(SimulatedArm& arm, const PoseStream& commands,
                                 const std::vector<double>& instants);

}  // namespace raven_correction
