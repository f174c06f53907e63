// SPDX-License-Identifier: BSD-3-Clause
// offline simulate: sessions from simulated robots, or what one would have done under measured
// commands.
#include <CLI/CLI.hpp>
#include <memory>
#include <set>

#include "raven_correction/dataset/dataset_directory.h"
#include "raven_correction/error.h"
#include "raven_correction/ros/offline.h"
#include "raven_correction/ros/session_bag.h"
#include "raven_correction/simulation/session.h"
#include "raven_correction/simulation/simulation_config.h"

namespace raven_correction {
namespace {

struct Arguments {
  std::vector<std::string> simulations, outputs;  // one output per simulation
  std::string commands, motion = "debridement";
  int trajectories = 60;
  std::uint64_t seed = 1;
};

bool isBag(const std::string& name) {
  return name.size() > 4 && name.compare(name.size() - 4, 4, ".bag") == 0;
}

void check(const Arguments& arguments) {
  for (const std::string& output : arguments.outputs) checkOutputFile(output, false);
  if (arguments.trajectories < 1)
    throw InvalidInput(format("--trajectories %d, must be at least 1", arguments.trajectories));
  if (arguments.outputs.size() != arguments.simulations.size())
    throw InvalidInput(format("%zu simulations and %zu outputs; give one -o per --simulation",
                              arguments.simulations.size(), arguments.outputs.size()));
  if (arguments.outputs.size() == 1) return;
  if (std::set<std::string>(arguments.outputs.begin(), arguments.outputs.end()).size() !=
      arguments.outputs.size())
    throw InvalidInput("-o names the same output twice");
  if (!arguments.commands.empty() || arguments.motion != "debridement")
    throw InvalidInput(
        "several arms at a time only do debridement; run --commands and --motion "
        "excitation once per arm");
}

std::vector<Dataset> sessionsOf(const Arguments& arguments,
                                const std::vector<SimulationConfig>& configs) {
  if (!arguments.commands.empty())
    return {simulateCommands(configs[0], readInput(arguments.commands), arguments.seed)};
  if (arguments.motion == "excitation")
    return {simulateExcitation(configs[0], ExcitationConfig(), arguments.seed)};
  return simulateSessions(configs, arguments.trajectories, arguments.seed);
}

void simulate(Arguments arguments) {
  if (arguments.simulations.empty())
    arguments.simulations = {packageFile("config/simulation/raven2_left_case2014.yaml")};
  check(arguments);
  std::vector<SimulationConfig> configs;
  for (const std::string& file : arguments.simulations)
    configs.push_back(loadSimulationConfig(file));
  const std::vector<Dataset> sessions = sessionsOf(arguments, configs);
  for (std::size_t i = 0; i < sessions.size(); ++i) {
    const std::string& output = arguments.outputs[i];
    if (isBag(output))
      writeSessionBag(sessions[i], output);
    else
      writeDatasetDirectory(sessions[i], output);
    std::printf("%s: %zu trajectories of \"%s\", seed %llu\n", output.c_str(),
                sessions[i].trajectories.size(), configs[i].name.c_str(),
                static_cast<unsigned long long>(arguments.seed));
  }
}

}  // namespace

void addSimulateCommand(CLI::App& app) {
  const auto arguments = std::make_shared<Arguments>();
  CLI::App* const command = app.add_subcommand("simulate", "Records a session of the simulation");
  command->add_option(
      "--simulation", arguments->simulations,
      "simulation file; default: config/simulation/raven2_left_case2014.yaml of the package; once "
      "per "
      "arm for arms that work at the same time and hide each other from the cameras");
  command
      ->add_option(
          "--motion", arguments->motion,
          "debridement, or excitation: every joint alone, for identification (as many motions "
          "as that takes)")
      ->check(CLI::IsMember({"debridement", "excitation"}));
  command->add_option("--trajectories", arguments->trajectories, "number of motions");
  command->add_option("--seed", arguments->seed, "of every random choice");
  command->add_option("--commands", arguments->commands,
                      "bag or directory whose commands are executed instead of random motions");
  command
      ->add_option("-o,--output", arguments->outputs,
                   "directory, or bag (*.bag), to write; once per arm")
      ->required();
  command->callback([arguments] { simulate(*arguments); });
}

}  // namespace raven_correction
