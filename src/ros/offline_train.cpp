// SPDX-License-Identifier: BSD-3-Clause
// offline train: clean, fit, save; prints what was learnt.
#include <CLI/CLI.hpp>
#include <chrono>
#include <memory>
#include <optional>

#include "raven_correction/correction/training.h"
#include "raven_correction/error.h"
#include "raven_correction/report/training_html.h"
#include "raven_correction/report/training_report.h"
#include "raven_correction/ros/command_record.h"
#include "raven_correction/ros/model_file.h"
#include "raven_correction/ros/offline.h"
#include "raven_correction/ros/session_bag.h"

namespace raven_correction {
namespace {

struct Arguments {
  std::vector<std::string> inputs;
  std::string output, config, hold_out, report, simulation;
  NumberFiles numbers;
  std::vector<std::string> robots;
  bool force = false, ignore_checks = false;
};

/// The model is judged on the trajectories that were left out of it. Where none were, one that was
/// trained in the same way on four fifths is judged on the last fifth.
TrainingPage pageOf(const TrainingResult& result, const Dataset& all, const Dataset& learnt,
                    const TrainingConfig& config, const std::string& hold_out) {
  TrainingPage page;
  const double max_gap = commandGapLimit(all, config);
  if (!hold_out.empty()) {
    const Dataset left_out = selectFold(all, parseHoldOut(hold_out), true);
    page.held_out = heldOutErrors(result.model, left_out, max_gap);
    page.judged =
        format("This model was judged on the %zu trajectories that --hold-out %s left out.",
               left_out.trajectories.size(), hold_out.c_str());
  } else {
    const Dataset left_out = selectFold(all, HoldOut{0, 5}, true);
    const TrainingResult partial = train(
        selectFold(all, HoldOut{0, 5}, false), config, 0.0,
        [](const std::string& phase, double part) { showProgress("report: " + phase, part); });
    page.held_out = heldOutErrors(partial.model, left_out, max_gap);
    page.judged = format(
        "This model has seen all trajectories; one trained in the same way without "
        "every fifth of them was judged on those %zu.",
        left_out.trajectories.size());
  }
  if (config.simulation)
    page.overlap =
        overlapOf(*config.simulation,
                  selectFold(all, hold_out.empty() ? HoldOut{0, 5} : parseHoldOut(hold_out), true));
  page.coverage = workspaceCoverage(learnt, config, result.model.delay);
  page.streams = streamHealth(all);
  return page;
}

void train(const Arguments& arguments) {
  checkOutputFile(arguments.output, arguments.force);
  checkNumberFiles(arguments.numbers);
  checkOutputFile(arguments.report, true);
  TrainingConfig config = loadTrainingConfig(
      arguments.config.empty() ? packageFile("config/trainer.yaml") : arguments.config);
  if (!arguments.simulation.empty())
    config.simulation =
        std::make_shared<const SimulationConfig>(loadSimulationConfig(arguments.simulation));
  const CheckedInputs inputs =
      readTrusted(arguments.inputs, arguments.robots, arguments.ignore_checks);
  const Dataset& all = inputs.dataset;
  constexpr std::size_t kLeast = 3;
  if (!arguments.report.empty() && all.trajectories.size() < kLeast)
    throw InvalidInput(
        format("%s: %zu trajectories; --report judges the model on trajectories left "
               "out and needs at least %zu: record more, or leave --report out",
               all.source.c_str(), all.trajectories.size(), kLeast));
  const Dataset dataset =
      arguments.hold_out.empty() ? all : selectFold(all, parseHoldOut(arguments.hold_out), false);
  const auto now = std::chrono::duration_cast<std::chrono::seconds>(
      std::chrono::system_clock::now().time_since_epoch());
  TrainingResult result = train(dataset, config, static_cast<double>(now.count()), showProgress);
  result.model.homed_at = inputs.homed_at;
  writeModelFile(result.model, arguments.output, arguments.force);
  std::printf("model %s written to %s\n", result.model.id.c_str(), arguments.output.c_str());
  // Where trajectories were left out, judging costs nothing; else a page is worth another training.
  std::optional<TrainingPage> page;
  if (!arguments.report.empty() || !arguments.hold_out.empty()) {
    page = pageOf(result, all, dataset, config, arguments.hold_out);
    page->model_file = arguments.output;
    page->findings = inputs.findings;
  }
  const TrainingPage* const judged = page ? &*page : nullptr;
  std::fputs(trainingText(result, judged).c_str(), stdout);
  writeNumbers(arguments.numbers, trainingJson(result, arguments.output, judged));
  if (arguments.report.empty()) return;
  RunRecord run = recordRun(arguments.inputs);
  run.settings = {{"configuration", arguments.config.empty() ? "config/trainer.yaml of the package"
                                                             : arguments.config},
                  {"simulation", arguments.simulation.empty() ? "that of the configuration, or none"
                                                              : arguments.simulation},
                  {"seed", std::to_string(config.process.seed)}};
  writeTextFile(arguments.report, trainingHtml(result, *page, run));
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
  addNumberOptions(*command, arguments->numbers);
  command->add_option("--report", arguments->report,
                      "write what was learnt as a page with figures (HTML, one file)");
  command->add_flag("--force", arguments->force, "replace the model file if it exists");
  addCheckOptions(*command, arguments->robots, arguments->ignore_checks);
  command->callback([arguments] { train(*arguments); });
}

}  // namespace raven_correction
