// SPDX-License-Identifier: BSD-3-Clause
// What the experiments share that start nodes on a ROS master of their own (private_launch.h).
#pragma once

#include <CLI/App.hpp>
#include <string>

#include "raven_correction/ros/private_launch.h"

namespace raven_correction {

/// Adds its subcommand to the command `experiment`, as those of offline.h.
void addDebridementExperiment(CLI::App& experiment);

/// Where the nodes write: `output`, made if need be; without one a temporary folder, which the
/// caller removes, so that it stays, with the nodes' log, when the experiment fails.
/// @throws InvalidInput  `output` is not empty, or the folder cannot be made
std::string experimentFolder(const std::string& experiment, const std::string& output);

/// Returns when the corrector says in /diagnostics that it uses this model. A model that is live at
/// the trainer is still on its way, and the corrector passes on what comes before it as it is.
/// @param corrector  resolved name of the node
/// @throws std::runtime_error  it does not say so within 20 s (real), or the nodes have ended
void waitForModel(const std::string& corrector, const std::string& model, PrivateLaunch& launch);

}  // namespace raven_correction
