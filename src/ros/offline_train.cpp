// SPDX-License-Identifier: BSD-3-Clause
// offline train: clean, fit, save; prints what was learnt.
#include <CLI/CLI.hpp>
#include <chrono>
#include <memory>

#include "raven_correction/correction/training.h"
#include "raven_correction/report/training_report.h"
#include "raven_correction/ros/model_file.h"
#include "raven_correction/ros/offline.h"
#include "raven_correction/ros/session_bag.h"

namespace raven_correction {
namespace {

struct Arguments {
  std::vector<std::string> inputs;
  std::string output, config, hold_out, json, simulation;
  bool force = false;
};

void train(const Arguments& arguments) {
  checkOutputFile(arguments.output, arguments.force);
  checkOutputFile(arguments.json, true);
  TrainingConfig config = loadTrainingConfig(
      arguments.config.empty() ? packageFile("config/trainer.yaml") : arguments.config);
  if (!arguments.simulation.empty())
    config.simulation =
        std::make_shared<const SimulationConfig>(loadSimulationConfig(arguments.simulation));
  Dataset dataset = readInputs(arguments.inputs);
  if (!arguments.hold_out.empty())
    dataset = selectFold(dataset, parseHoldOut(arguments.hold_out), false);
  const auto now = std::chrono::duration_cast<std::chrono::seconds>(
      std::chrono::system_clock::now().time_since_epoch());
  const TrainingResult result =
      train(dataset, config, static_cast<double>(now.count()), showProgress);
  writeModelFile(result.model, arguments.output, arguments.force);
  std::fputs(trainingText(result).c_str(), stdout);
  std::printf("model %s written to %s\n", result.model.id.c_str(), arguments.output.c_str());
  if (!arguments.json.empty())
    writeTextFile(arguments.json, trainingJson(result, arguments.output));
}

}  // namespace

void addTrainCommand(CLI::App& app) {
  const auto arguments = std::make_shared<Arguments>();
  CLI::App* const command = app.add_subcommand("train", "Cleans, fits and saves a model");
  command->add_option("INPUT", arguments->inputs, "bags or data set directories")->required();
  command->add_option("-o,--output", arguments->output, "model file to write")->required();
  command->add_option("--config", arguments->config,
                      "trainer configuration; default: config/trainer.yaml of the package");
  command->add_option(
      "--simulation", arguments->simulation,
      "physics as the mean: simulation file (diagnose -o writes one) whose way back "
      "from pose to command comes before the process; default: that of the "
      "configuration, or none");
  command->add_option("--hold-out", arguments->hold_out,
                      "K/N: leave out trajectory i where i % N == K (zero-based, by start time)");
  command->add_option("--json", arguments->json, "write the numbers as JSON");
  command->add_flag("--force", arguments->force, "replace the model file if it exists");
  command->callback([arguments] { train(*arguments); });
}

}  // namespace raven_correction
