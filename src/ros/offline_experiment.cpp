// SPDX-License-Identifier: BSD-3-Clause
// offline experiment NAME: experiments of the paper and of this package. fidelity: how like a
// measured session the simulation is; physics: what physics as the mean of the regression is worth;
// repeatability (offline_repeatability.cpp): poses visited again and again through the nodes;
// fragments (offline_fragments.cpp): how well the stereo camera finds them; trace and
// learning-curve (offline_figures.cpp): two figures of the paper.
#include <CLI/CLI.hpp>
#include <memory>

#include "raven_correction/evaluation/fidelity.h"
#include "raven_correction/evaluation/learning_curve.h"
#include "raven_correction/report/fidelity_html.h"
#include "raven_correction/report/fidelity_report.h"
#include "raven_correction/report/learning_curve_report.h"
#include "raven_correction/ros/command_record.h"
#include "raven_correction/ros/live_experiment.h"
#include "raven_correction/ros/offline.h"
#include "raven_correction/ros/session_bag.h"

namespace raven_correction {
namespace {

struct FidelityArguments {
  std::string input, simulation, config, hold_out = "0/5", report;
  NumberFiles numbers;
  std::uint64_t seed = 1;
};

void fidelity(const FidelityArguments& arguments) {
  checkNumberFiles(arguments.numbers);
  checkOutputFile(arguments.report, true);
  FidelityProblem problem;
  problem.simulation = loadSimulationConfig(
      arguments.simulation.empty() ? packageFile("config/simulation/raven2_left_case2014.yaml")
                                   : arguments.simulation);
  problem.training = loadTrainingConfig(
      arguments.config.empty() ? packageFile("config/trainer.yaml") : arguments.config);
  problem.hold_out = parseHoldOut(arguments.hold_out);
  problem.seed = arguments.seed;
  const Dataset dataset = readInputs({arguments.input});
  const FidelityResult result = compareFidelity(dataset, problem, showProgress);
  std::fputs(fidelityText(result).c_str(), stdout);
  writeNumbers(arguments.numbers, fidelityJson(result));
  if (arguments.report.empty()) return;
  RunRecord run = recordRun({arguments.input});
  run.settings = {{"simulation", arguments.simulation.empty()
                                     ? "config/simulation/raven2_left_case2014.yaml of the package"
                                     : arguments.simulation},
                  {"configuration", arguments.config.empty() ? "config/trainer.yaml of the package"
                                                             : arguments.config},
                  {"hold-out", arguments.hold_out},
                  {"seed", std::to_string(arguments.seed)}};
  run.configuration = problem.training.text;
  writeTextFile(arguments.report, fidelityHtml(result, streamHealth(dataset), run));
}

struct PhysicsArguments {
  std::vector<std::string> inputs, simulations;
  std::string config, draw = "pairs";
  NumberFiles numbers;
  LearningCurveProblem problem;
};

void physics(const PhysicsArguments& arguments) {
  checkNumberFiles(arguments.numbers);
  LearningCurveProblem problem = arguments.problem;
  problem.config = loadTrainingConfig(arguments.config.empty() ? packageFile("config/trainer.yaml")
                                                               : arguments.config);
  problem.draw = arguments.draw == "pairs" ? TrainingConfig::Draw::kPairs
                                           : TrainingConfig::Draw::kTrajectories;
  for (const std::string& file : arguments.simulations)
    problem.simulations.push_back(
        std::make_shared<const SimulationConfig>(loadSimulationConfig(file)));
  const LearningCurveResult result =
      learningCurve(readInputs(arguments.inputs), problem, showProgress);
  std::fputs(learningCurveText(result).c_str(), stdout);
  writeNumbers(arguments.numbers, learningCurveJson(result));
}

void addPhysics(CLI::App& experiment) {
  const auto arguments = std::make_shared<PhysicsArguments>();
  CLI::App* const command = experiment.add_subcommand(
      "physics",
      "Regression alone against regression about a simulation (physics first), by the number of "
      "training pairs, on trajectories left out; and how many pairs the simulation saves");
  command->add_option("INPUT", arguments->inputs, "bags or data set directories")->required();
  command
      ->add_option("--simulation", arguments->simulations,
                   "simulation file, or one per fold in order (diagnose --hold-out K/N -o F writes "
                   "one that has not seen what fold K tests on)")
      ->required();
  command->add_option("--pairs", arguments->problem.pairs,
                      "numbers of training pairs; default 100 300 1000 4000");
  command
      ->add_option("--draw", arguments->draw,
                   "pairs: one by one from all trajectories; trajectories: whole ones, until there "
                   "are enough; default pairs")
      ->check(CLI::IsMember({"pairs", "trajectories"}));
  command->add_option("--folds", arguments->problem.folds, "trajectory i tests in fold i % N")
      ->check(CLI::Range(2, 100));
  command->add_option("--only", arguments->problem.only_folds, "of these folds; default: all");
  command->add_option("--config", arguments->config,
                      "training configuration; default: config/trainer.yaml of the package");
  command->add_option("--seed", arguments->problem.seed, "of draws and bootstrap; default 1");
  addNumberOptions(*command, arguments->numbers);
  command->callback([arguments] { physics(*arguments); });
}

}  // namespace

void addExperimentCommand(CLI::App& app) {
  CLI::App* const experiment = app.add_subcommand("experiment", "Experiments, by name");
  experiment->require_subcommand(1);
  addPhysics(*experiment);
  addFigureExperiments(*experiment);
  addRepeatabilityExperiment(*experiment);
  addFragmentsExperiment(*experiment);
  addDebridementExperiment(*experiment);
  const auto arguments = std::make_shared<FidelityArguments>();
  CLI::App* const command =
      experiment->add_subcommand("fidelity",
                                 "Drives the simulation with the measured commands and prints, "
                                 "measured against simulated, on "
                                 "the trajectories of one fold (a test where the simulation was "
                                 "not fitted to them): errors, "
                                 "delay, cleaning, timing, errors "
                                 "against joints and speed, and Table I");
  command->add_option("INPUT", arguments->input, "bag or data set directory")->required();
  command->add_option("--simulation", arguments->simulation,
                      "default: config/simulation/raven2_left_case2014.yaml of the package");
  command->add_option("--config", arguments->config,
                      "training configuration; default: config/trainer.yaml of the package");
  command->add_option("--hold-out", arguments->hold_out,
                      "K/N: figures come from trajectory i where i % N == K; default 0/5");
  command->add_option("--seed", arguments->seed, "of the simulated motion capture; default 1");
  addNumberOptions(*command, arguments->numbers);
  command->add_option("--report", arguments->report,
                      "write the comparison as a page with figures (HTML, one file)");
  command->callback([arguments] { fidelity(*arguments); });
}

}  // namespace raven_correction
