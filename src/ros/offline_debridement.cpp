// SPDX-License-Identifier: BSD-3-Clause
// offline experiment debridement: section V-D of the paper on simulated arms, through the real
// nodes, on a ROS master that the command starts and ends.
#include <CLI/CLI.hpp>
#include <cstdlib>
#include <filesystem>
#include <memory>

#include "raven_correction/error.h"
#include "raven_correction/report/debridement_report.h"
#include "raven_correction/ros/command_record.h"
#include "raven_correction/ros/debridement_experiment.h"
#include "raven_correction/ros/live_experiment.h"
#include "raven_correction/ros/offline.h"

namespace raven_correction {
namespace {

struct Arguments {
  DebridementParams params;
  std::string output, report;
  NumberFiles numbers;
};

void writeReport(const Arguments& arguments, const DebridementParams& params,
                 const DebridementReport& report) {
  RunRecord record = recordRun({});
  record.settings = {{"fragments", std::to_string(params.fragments)},
                     {"arms", std::to_string(params.arms)},
                     {"places to learn from", std::to_string(params.rehearsals)},
                     {"attempts", std::to_string(params.attempts)},
                     {"seed", std::to_string(params.seed)}};
  writeTextFile(arguments.report, debridementHtml(report, record));
}

void run(const Arguments& arguments) {
  checkNumberFiles(arguments.numbers);
  checkOutputFile(arguments.report, true);
  DebridementParams params = arguments.params;
  checkDebridement(params);
  params.folder = experimentFolder("debridement", arguments.output);
  DebridementReport report = runDebridement(params, showProgress);
  if (arguments.output.empty()) report.folder.clear();
  writeNumbers(arguments.numbers, debridementJson(report));
  std::fputs(debridementText(report).c_str(), stdout);
  if (!arguments.report.empty()) writeReport(arguments, params, report);
  if (arguments.output.empty()) std::filesystem::remove_all(params.folder);
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
      "on "
      "a "
      "ROS master of its own");
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
  command->add_option(
      "--output", arguments->output,
      "keep bags, models, every grasp (grasps.csv) and log in this folder (empty or "
      "new)");
  addNumberOptions(*command, arguments->numbers);
  command->add_option("--report", arguments->report, "write a page with figures (HTML, one file)");
  command->callback([arguments] { run(*arguments); });
}

}  // namespace raven_correction
