// SPDX-License-Identifier: BSD-3-Clause
// What the experiments share that start nodes on a ROS master of their own (private_launch.h).
#pragma once

#include <CLI/App.hpp>
#include <string>

namespace raven_correction {

/// Adds its subcommand to the command `experiment`, as those of offline.h.
void addDebridementExperiment(CLI::App& experiment);

/// Where the nodes write: `output`, made if need be; without one a temporary folder, which the
/// caller removes, so that it stays, with the nodes' log, when the experiment fails.
/// @throws InvalidInput  `output` is not empty, or the folder cannot be made
std::string experimentFolder(const std::string& experiment, const std::string& output);

}  // namespace raven_correction
