// SPDX-License-Identifier: BSD-3-Clause
// offline experiment repeatability: Table II of the paper on the simulated robot, through the real
// nodes, on a ROS master that the command starts and ends.
#include <CLI/CLI.hpp>
#include <memory>

#include "raven_correction/error.h"
#include "raven_correction/report/repeatability_report.h"
#include "raven_correction/ros/live_experiment.h"
#include "raven_correction/ros/offline.h"
#include "raven_correction/ros/repeatability_experiment.h"

namespace raven_correction {
namespace {

struct Arguments {
  RepeatabilityParams params;
  LiveFiles files;
};

void run(const Arguments& arguments) {
  RepeatabilityParams params = arguments.params;
  checkRepeatability(params);
  runLiveExperiment(
      "repeatability", arguments.files, [&](const std::string& folder, const std::string& shown) {
        params.folder = folder;
        RepeatabilityReport report = runRepeatability(params, showProgress);
        report.folder = shown;
        return LiveResult{repeatabilityText(report),
                          repeatabilityJson(report),
                          [report](const RunRecord& run) { return repeatabilityHtml(report, run); },
                          {{"poses", std::to_string(params.poses)},
                           {"visits of each", std::to_string(params.visits)},
                           {"motions to learn from", std::to_string(params.trajectories)},
                           {"seed", std::to_string(params.seed)}}};
      });
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
  addLiveFiles(*command, arguments->files, "bags, model");
  command->callback([arguments] { run(*arguments); });
}

}  // namespace raven_correction
