// SPDX-License-Identifier: BSD-3-Clause
// offline experiment debridement: section V-D of the paper on simulated arms, through the real
// nodes, on a ROS master that the command starts and ends.
#include <CLI/CLI.hpp>
#include <memory>

#include "raven_correction/error.h"
#include "raven_correction/report/debridement_report.h"
#include "raven_correction/ros/debridement_experiment.h"
#include "raven_correction/ros/live_experiment.h"
#include "raven_correction/ros/offline.h"

namespace raven_correction {
namespace {

struct Arguments {
  DebridementParams params;
  LiveFiles files;
};

void run(const Arguments& arguments) {
  DebridementParams params = arguments.params;
  checkDebridement(params);
  runLiveExperiment(
      "debridement", arguments.files, [&](const std::string& folder, const std::string& shown) {
        params.folder = folder;
        DebridementReport report = runDebridement(params, showProgress);
        report.folder = shown;
        return LiveResult{debridementText(report),
                          debridementJson(report),
                          [report](const RunRecord& run) { return debridementHtml(report, run); },
                          {{"fragments", std::to_string(params.fragments)},
                           {"arms", std::to_string(params.arms)},
                           {"places to learn from", std::to_string(params.rehearsals)},
                           {"attempts", std::to_string(params.attempts)},
                           {"seed", std::to_string(params.seed)}}};
      });
}

}  // namespace

void addDebridementExperiment(CLI::App& experiment) {
  const auto arguments = std::make_shared<Arguments>();
  DebridementParams& params = arguments->params;
  CLI::App* const command = experiment.add_subcommand(
      "debridement",
      "Section V-D of the paper: fragments of foam are found by a stereo camera, picked up and "
      "carried away; slowly and replanning without correction, fast and open loop with it, and "
      "replanning where the correction is not sure. Through the real nodes and simulated arms, "
      "on a ROS master of its own");
  command->add_option("--fragments", params.fragments,
                      "in each condition, at least: whole scenes are cleared; default 60");
  command->add_option("--arms", params.arms,
                      format("that share the field; default %u", params.arms));
  command->add_option(
      "--rehearsals", params.rehearsals,
      format("places of which each arm learns, with what it learnt at half as many places without "
             "correction before; default %u",
             params.rehearsals));
  command->add_option("--attempts", params.attempts,
                      format("until a fragment is given up; default %u", params.attempts));
  command->add_option(
      "--deviation-limit", params.deviation_limit,
      format("corrected_replanning measures the tool pose where a larger deviation is "
             "predicted, one standard deviation of the position [m]; default %g: more than at "
             "three in "
             "four of the places that it tried",
             params.deviation_limit));
  command->add_option("--condition", params.conditions,
                      "baseline, corrected or corrected_replanning, or some of them; default: all");
  command->add_option("--seed", params.seed, "of scenes, rehearsals and noise; default 1");
  command->add_option(
      "--clock-rate", params.clock_rate,
      format("simulated seconds per real second, at most; default %g", params.clock_rate));
  command->add_option("--config", params.configuration,
                      "training configuration; default: config/trainer.yaml of the package");
  addLiveFiles(*command, arguments->files, "bags, models, every grasp (grasps.csv)");
  command->callback([arguments] { run(*arguments); });
}

}  // namespace raven_correction
