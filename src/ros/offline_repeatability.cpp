// SPDX-License-Identifier: BSD-3-Clause
// offline experiment repeatability: Table II of the paper on the simulated robot, through the real
// nodes, on a ROS master that the command starts and ends.
#include <CLI/CLI.hpp>
#include <filesystem>
#include <memory>

#include "raven_correction/error.h"
#include "raven_correction/report/repeatability_report.h"
#include "raven_correction/ros/command_record.h"
#include "raven_correction/ros/live_experiment.h"
#include "raven_correction/ros/offline.h"
#include "raven_correction/ros/repeatability_experiment.h"

namespace raven_correction {
namespace {

namespace fs = std::filesystem;

struct Arguments {
  RepeatabilityParams params;
  std::string output, report;
  NumberFiles numbers;
};

void run(const Arguments& arguments) {
  checkNumberFiles(arguments.numbers);
  checkOutputFile(arguments.report, true);
  RepeatabilityParams params = arguments.params;
  checkRepeatability(params);
  params.folder = experimentFolder("repeatability", arguments.output);
  RepeatabilityReport report = runRepeatability(params, showProgress);
  if (arguments.output.empty()) report.folder.clear();
  writeNumbers(arguments.numbers, repeatabilityJson(report));
  std::fputs(repeatabilityText(report).c_str(), stdout);
  if (!arguments.report.empty()) {
    RunRecord record = recordRun({});
    record.settings = {{"poses", std::to_string(params.poses)},
                       {"visits of each", std::to_string(params.visits)},
                       {"motions to learn from", std::to_string(params.trajectories)},
                       {"seed", std::to_string(params.seed)}};
    writeTextFile(arguments.report, repeatabilityHtml(report, record));
  }
  if (arguments.output.empty()) fs::remove_all(params.folder);
}

}  // namespace

void addRepeatabilityExperiment(CLI::App& experiment) {
  const auto arguments = std::make_shared<Arguments>();
  RepeatabilityParams& params = arguments->params;
  CLI::App* const command = experiment.add_subcommand(
      "repeatability",
      "Table II of the paper: random fragment poses, each visited many times open loop; without "
      "correction, with every pose of the trajectory corrected, and with its endpoints only. "
      "Through the real nodes and the simulated robot, on a ROS master of its own");
  command->add_option("--poses", params.poses, "fragment poses; default 10");
  command->add_option("--visits", params.visits, "of each pose and condition; default 10");
  command->add_option("--trajectories", params.trajectories,
                      "motions recorded to learn from, without correction; default " +
                          std::to_string(params.trajectories));
  command->add_option("--seed", params.seed, "of poses, orders, motions and noise; default 1");
  command->add_option(
      "--clock-rate", params.clock_rate,
      format("simulated seconds per real second, at most; default %g", params.clock_rate));
  command->add_option("--simulation", params.simulation,
                      "simulation file; default: config/simulation/demo.yaml of the package");
  command->add_flag("!--no-play", params.play,
                    "the model does not know from which side each joint of the robot has come");
  command->add_option("--config", params.configuration,
                      "training configuration; default: config/trainer.yaml of the package");
  command->add_option("--output", arguments->output,
                      "keep bags, model and log in this folder (empty or new)");
  addNumberOptions(*command, arguments->numbers);
  command->add_option("--report", arguments->report, "write a page with figures (HTML, one file)");
  command->callback([arguments] { run(*arguments); });
}

}  // namespace raven_correction
