// SPDX-License-Identifier: BSD-3-Clause
// offline diagnose: what the simulation gets wrong about a recording, and why.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <fstream>
#include <memory>

#include "raven_correction/error.h"
#include "raven_correction/report/diagnosis_html.h"
#include "raven_correction/report/diagnosis_report.h"
#include "raven_correction/ros/command_record.h"
#include "raven_correction/ros/offline.h"
#include "raven_correction/ros/session_bag.h"

namespace raven_correction {
namespace {

struct Arguments {
  std::vector<std::string> inputs, prismatic;
  std::string simulation, output, json, report, from = "commands";
  bool ignore_encoders = false;
  DiagnosisOptions options;
};

/// Which joints of a joint recording are in metres: as the data set or the user says.
std::vector<bool> prismaticJoints(const Dataset& dataset, const std::vector<std::string>& named) {
  std::vector<std::string> names;
  for (const Trajectory& trajectory : dataset.trajectories)
    if (names.empty()) names = trajectory.joint_commands.names;
  for (const std::string& name : named)
    if (std::find(names.begin(), names.end(), name) == names.end())
      throw InvalidInput(format("--prismatic %s: the recording has no such joint", name.c_str()));
  std::vector<bool> prismatic;
  for (const std::string& name : names) {
    const auto unit = dataset.joint_units.find(name);
    prismatic.push_back((unit != dataset.joint_units.end() && unit->second == "m") ||
                        std::find(named.begin(), named.end(), name) != named.end());
  }
  return prismatic;
}

void diagnoseInput(const Arguments& arguments) {
  checkOutputFile(arguments.output, false);
  checkOutputFile(arguments.json, true);
  checkOutputFile(arguments.report, true);
  const Dataset dataset = readInputs(arguments.inputs);
  const std::string simulation_file = arguments.simulation.empty()
                                          ? packageFile("config/simulation/nominal.yaml")
                                          : arguments.simulation;
  const SimulationConfig simulation = loadSimulationConfig(simulation_file);
  if (isJointData(dataset) && !arguments.output.empty())
    throw InvalidInput(format("-o %s: joint data has no robot to simulate; leave -o out",
                              arguments.output.c_str()));
  if (isJointData(dataset) && arguments.from == "encoders")
    throw InvalidInput("--from encoders: joint data has commands and observations only");
  DiagnosisOptions options = arguments.options;
  options.recording.source =
      arguments.from == "encoders" ? DriveSource::kEncoders : DriveSource::kCommands;
  options.recording.use_encoders = !arguments.ignore_encoders;
  Verdict verdict = diagnose(dataset, simulation, prismaticJoints(dataset, arguments.prismatic),
                             options, showProgress);
  showProgress("done", 1.0);
  std::fputs(diagnosisText(verdict).c_str(), stdout);
  if (!arguments.json.empty()) writeTextFile(arguments.json, diagnosisJson(verdict));
  if (!arguments.report.empty()) {
    RunRecord run = recordRun(arguments.inputs);
    run.settings = {
        {"simulation", arguments.simulation.empty()
                           ? "config/simulation/nominal.yaml of the package"
                           : arguments.simulation},
        {"driven by", arguments.from},
        {"at most so many samples", options.recording.max_samples == 0
                                        ? "all"
                                        : std::to_string(options.recording.max_samples)}};
    std::ifstream file(simulation_file);
    run.configuration.assign(std::istreambuf_iterator<char>(file), {});
    writeTextFile(arguments.report,
                  diagnosisHtml(verdict, streamHealth(dataset), arguments.output, run));
  }
  if (arguments.output.empty()) return;
  verdict.simulation.name = simulation.name + "_extended";
  verdict.simulation.description = "extended by what the diagnosis of " + dataset.name + " found";
  saveSimulationConfig(verdict.simulation, arguments.output);
  std::printf("wrote %s\n", arguments.output.c_str());
}

}  // namespace

void addDiagnoseCommand(CLI::App& app) {
  const auto arguments = std::make_shared<Arguments>();
  CLI::App* const command = app.add_subcommand("diagnose",
                                               "What the simulation gets wrong about a recording: "
                                               "names the physical causes, and measures what "
                                               "they explain on motions held out");
  command->add_option("INPUT", arguments->inputs, "bags or data set directories")->required();
  command->add_option("--simulation", arguments->simulation,
                      "simulation file; default: config/simulation/nominal.yaml of the package");
  command->add_option("-o,--output", arguments->output, "extended simulation file to write");
  command->add_option("--json", arguments->json, "write the verdict as JSON");
  command->add_option("--report", arguments->report,
                      "write the verdict as a page with figures (HTML, one file)");
  command
      ->add_option("--from", arguments->from,
                   "what drives the simulation: commands, or encoders (then only what lies behind "
                   "the motors is diagnosed)")
      ->check(CLI::IsMember({"commands", "encoders"}));
  command->add_flag("--ignore-encoders", arguments->ignore_encoders,
                    "encoder streams are no observations");
  command->add_option("--prismatic", arguments->prismatic,
                      "joint data: joints in metres, where dataset.yaml does not say so");
  command->add_option("--folds", arguments->options.selection.folds, "of the held-out motions")
      ->check(CLI::Range(2, 100));
  command->add_option("--max-causes", arguments->options.selection.max_causes, "at most so many")
      ->check(CLI::Range(0, 1000));
  command
      ->add_option("--max-samples", arguments->options.recording.max_samples,
                   "observations used, evenly spread; 0: all")
      ->check(CLI::Range(0, 100000000));
  command->add_option("--seed", arguments->options.selection.seed, "of the bootstrap");
  command->callback([arguments] { diagnoseInput(*arguments); });
}

}  // namespace raven_correction
