// SPDX-License-Identifier: BSD-3-Clause
// offline evaluate: Table I of the paper on trajectories not used in training.
#include <CLI/CLI.hpp>
#include <memory>

#include "raven_correction/evaluation/table_one.h"
#include "raven_correction/report/table_one_report.h"
#include "raven_correction/ros/offline.h"
#include "raven_correction/ros/session_bag.h"

namespace raven_correction {
namespace {

struct Arguments {
  std::vector<std::string> inputs, tests;
  std::string config, json;
};

void evaluate(const Arguments& arguments) {
  checkOutputFile(arguments.json, true);
  TableOneProblem problem;
  problem.configurations = {
      {"paper", loadTrainingConfig(packageFile("config/trainer_case2014.yaml"))},
      {"best", loadTrainingConfig(arguments.config.empty() ? packageFile("config/trainer.yaml")
                                                           : arguments.config)}};
  const Dataset dataset = readInputs(arguments.inputs);
  const TableOneResult result =
      arguments.tests.empty()
          ? crossValidate(dataset, problem, showProgress)
          : evaluateOn(dataset, readInputs(arguments.tests), problem, showProgress);
  std::fputs(tableOneText(result).c_str(), stdout);
  if (!arguments.json.empty()) writeTextFile(arguments.json, tableOneJson(result));
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
  command->add_option("--json", arguments->json, "write the numbers as JSON");
  command->callback([arguments] { evaluate(*arguments); });
}

}  // namespace raven_correction
