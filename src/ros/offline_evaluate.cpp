// SPDX-License-Identifier: BSD-3-Clause
// offline evaluate: Table I of the paper on trajectories not used in training.
#include <CLI/CLI.hpp>
#include <memory>

#include "raven_correction/evaluation/table_one.h"
#include "raven_correction/report/table_one_html.h"
#include "raven_correction/report/table_one_report.h"
#include "raven_correction/ros/command_record.h"
#include "raven_correction/ros/offline.h"
#include "raven_correction/ros/session_bag.h"

namespace raven_correction {
namespace {

struct Arguments {
  std::vector<std::string> inputs, tests;
  std::string config, report;
  NumberFiles numbers;
  std::vector<std::string> robots;
  bool ignore_checks = false;
};

void evaluate(const Arguments& arguments) {
  checkNumberFiles(arguments.numbers);
  checkOutputFile(arguments.report, true);
  TableOneProblem problem;
  problem.configurations = {
      {"paper", loadTrainingConfig(packageFile("config/trainer_case2014.yaml"))},
      {"best", loadTrainingConfig(arguments.config.empty() ? packageFile("config/trainer.yaml")
                                                           : arguments.config)}};
  if (problem.configurations.back().second.simulation)
    std::fputs(
        "the simulation of the configuration is left out: Table I compares methods without physics "
        "(experiment physics compares with it)\n",
        stderr);
  ErrorSamples samples;
  if (!arguments.report.empty()) problem.observer = samples.observer();
  const CheckedInputs checked =
      readTrusted(arguments.inputs, arguments.robots, arguments.ignore_checks);
  const Dataset& dataset = checked.dataset;
  const TableOneResult result =
      arguments.tests.empty()
          ? crossValidate(dataset, problem, showProgress)
          : evaluateOn(
                dataset,
                readTrusted(arguments.tests, arguments.robots, arguments.ignore_checks).dataset,
                problem, showProgress);
  std::fputs(tableOneText(result).c_str(), stdout);
  writeNumbers(arguments.numbers, tableOneJson(result));
  if (arguments.report.empty()) return;
  std::vector<std::string> inputs = arguments.inputs;
  inputs.insert(inputs.end(), arguments.tests.begin(), arguments.tests.end());
  RunRecord run = recordRun(inputs);
  run.settings = {
      {"configuration \"best\"",
       arguments.config.empty() ? "config/trainer.yaml of the package" : arguments.config},
      {"configuration \"paper\"", "config/trainer_case2014.yaml of the package"},
      {"seed", std::to_string(problem.configurations.back().second.process.seed)}};
  for (const StreamFinding& finding : checked.findings)
    run.settings.emplace_back("check of the streams", toText(finding));
  run.configuration = problem.configurations.back().second.text;
  writeTextFile(arguments.report, tableOneHtml(result, samples, streamHealth(dataset), run));
}

}  // namespace

void addEvaluateCommand(CLI::App& app) {
  const auto arguments = std::make_shared<Arguments>();
  CLI::App* const command = app.add_subcommand(
      "evaluate",
      "Table I of the paper: six methods on dirty and clean test sets, on trajectories not used in "
      "training (five folds, or a test set of its own)");
  command->add_option("INPUT", arguments->inputs, "bags or data set directories")->required();
  command->add_option("--test", arguments->tests,
                      "bags or directories to test on instead of folds");
  command->add_option("--config", arguments->config,
                      "configuration \"best\"; default: config/trainer.yaml of the package");
  addNumberOptions(*command, arguments->numbers);
  command->add_option("--report", arguments->report,
                      "write the tables as a page with figures (HTML, one file)");
  addCheckOptions(*command, arguments->robots, arguments->ignore_checks);
  command->callback([arguments] { evaluate(*arguments); });
}

}  // namespace raven_correction
