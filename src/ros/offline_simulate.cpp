// SPDX-License-Identifier: BSD-3-Clause
// offline simulate: a session from the simulated robot, or what it would have done under measured
// commands.
#include <CLI/CLI.hpp>
#include <memory>

#include "raven_correction/dataset/dataset_directory.h"
#include "raven_correction/error.h"
#include "raven_correction/ros/offline.h"
#include "raven_correction/ros/session_bag.h"
#include "raven_correction/simulation/session.h"
#include "raven_correction/simulation/simulation_config.h"

namespace raven_correction {
namespace {

struct Arguments {
  std::string simulation, commands, output;
  int trajectories = 60;
  std::uint64_t seed = 1;
};

bool isBag(const std::string& name) {
  return name.size() > 4 && name.compare(name.size() - 4, 4, ".bag") == 0;
}

void simulate(const Arguments& arguments) {
  checkOutputFile(arguments.output, false);
  if (arguments.trajectories < 1)
    throw InvalidInput(format("--trajectories %d, must be at least 1", arguments.trajectories));
  const SimulationConfig config = loadSimulationConfig(
      arguments.simulation.empty() ? packageFile("config/simulation/raven2_left_case2014.yaml")
                                   : arguments.simulation);
  const Dataset session =
      arguments.commands.empty()
          ? simulateSession(config, arguments.trajectories, arguments.seed)
          : simulateCommands(config, readInput(arguments.commands), arguments.seed);
  if (isBag(arguments.output))
    writeSessionBag(session, arguments.output);
  else
    writeDatasetDirectory(session, arguments.output);
  std::printf("%s: %zu trajectories of \"%s\", seed %llu\n", arguments.output.c_str(),
              session.trajectories.size(), config.name.c_str(),
              static_cast<unsigned long long>(arguments.seed));
}

}  // namespace

void addSimulateCommand(CLI::App& app) {
  const auto arguments = std::make_shared<Arguments>();
  CLI::App* const command = app.add_subcommand("simulate", "Records a session of the simulation");
  command->add_option(
      "--simulation", arguments->simulation,
      "simulation file; default: config/simulation/raven2_left_case2014.yaml of the package");
  command->add_option("--trajectories", arguments->trajectories, "number of motions");
  command->add_option("--seed", arguments->seed, "of every random choice");
  command->add_option("--commands", arguments->commands,
                      "bag or directory whose commands are executed instead of random motions");
  command->add_option("-o,--output", arguments->output, "directory, or bag (*.bag), to write")
      ->required();
  command->callback([arguments] { simulate(*arguments); });
}

}  // namespace raven_correction
