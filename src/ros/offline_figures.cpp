// SPDX-License-Identifier: BSD-3-Clause
// offline experiment trace and learning-curve: the paper's Fig. 4 and Fig. 5 on any recording.
#include <CLI/CLI.hpp>
#include <memory>

#include "raven_correction/report/learning_curve_report.h"
#include "raven_correction/report/test_trace_report.h"
#include "raven_correction/ros/command_record.h"
#include "raven_correction/ros/offline.h"
#include "raven_correction/ros/session_bag.h"

namespace raven_correction {
namespace {

struct Files {
  std::vector<std::string> inputs;
  std::string config, report;
  NumberFiles numbers;
};

void addFiles(CLI::App& command, Files& files) {
  command.add_option("INPUT", files.inputs, "bags or data set directories")->required();
  command.add_option("--config", files.config,
                     "training configuration; default: config/trainer.yaml of the package");
  addNumberOptions(command, files.numbers);
  command.add_option("--report", files.report, "write a page with figures (HTML, one file)");
}

TrainingConfig prepare(const Files& files) {
  checkNumberFiles(files.numbers);
  checkOutputFile(files.report, true);
  return loadTrainingConfig(files.config.empty() ? packageFile("config/trainer.yaml")
                                                 : files.config);
}

RunRecord recordOf(const Files& files, const TrainingConfig& config) {
  RunRecord run = recordRun(files.inputs);
  run.settings = {{"configuration",
                   files.config.empty() ? "config/trainer.yaml of the package" : files.config}};
  run.configuration = config.text;
  return run;
}

struct TraceArguments {
  Files files;
  std::string hold_out = "0/5";
  TraceProblem problem;
};

void trace(const TraceArguments& arguments) {
  const Files& files = arguments.files;
  TraceProblem problem = arguments.problem;
  problem.config = prepare(files);
  problem.hold_out = parseHoldOut(arguments.hold_out);
  const TraceResult result = testTrace(readInputs(files.inputs), problem, showProgress);
  std::fputs(testTraceText(result).c_str(), stdout);
  writeNumbers(files.numbers, testTraceJson(result));
  if (files.report.empty()) return;
  RunRecord run = recordOf(files, problem.config);
  run.settings.emplace_back("hold-out", arguments.hold_out);
  run.settings.emplace_back("states", std::to_string(problem.states));
  writeTextFile(files.report, testTraceHtml(result, run));
}

struct CurveArguments {
  Files files;
  LearningCurveProblem problem;
};

void curve(const CurveArguments& arguments) {
  const Files& files = arguments.files;
  LearningCurveProblem problem = arguments.problem;
  problem.config = prepare(files);
  const LearningCurveResult result = learningCurve(readInputs(files.inputs), problem, showProgress);
  std::fputs(learningCurveText(result).c_str(), stdout);
  writeNumbers(files.numbers, learningCurveJson(result));
  if (files.report.empty()) return;
  RunRecord run = recordOf(files, problem.config);
  run.settings.emplace_back("folds", std::to_string(problem.folds));
  run.settings.emplace_back("seed", std::to_string(problem.seed));
  writeTextFile(files.report, learningCurveHtml(result, run));
}

}  // namespace

void addFigureExperiments(CLI::App& experiment) {
  const auto one = std::make_shared<TraceArguments>();
  CLI::App* const trace_command = experiment.add_subcommand(
      "trace",
      "Fig. 4 of the paper: x, y, z over test states of motions left out; command, observation, "
      "rigid step and whole model");
  addFiles(*trace_command, one->files);
  trace_command->add_option("--states", one->problem.states, "test states, from the first; 1000");
  trace_command->add_option("--hold-out", one->hold_out,
                            "K/N: trajectory i is left out where i % N == K; default 0/5");
  trace_command->callback([one] { trace(*one); });

  const auto many = std::make_shared<CurveArguments>();
  many->problem.pairs = {50, 100, 200, 460, 1000, 2000, 4000};
  CLI::App* const curve_command = experiment.add_subcommand(
      "learning-curve",
      "Fig. 5 of the paper: errors on motions left out, and the time of training, against the "
      "number of training states");
  addFiles(*curve_command, many->files);
  curve_command->add_option("--states", many->problem.pairs,
                            "numbers of training states; default 50 100 200 460 1000 2000 4000");
  curve_command->add_option("--folds", many->problem.folds, "trajectory i tests in fold i % N")
      ->check(CLI::Range(2, 100));
  curve_command->add_option("--only", many->problem.only_folds, "of these folds; default: all");
  curve_command->add_option("--seed", many->problem.seed, "of the draws; default 1");
  curve_command->callback([many] { curve(*many); });
}

}  // namespace raven_correction
