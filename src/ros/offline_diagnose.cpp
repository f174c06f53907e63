// SPDX-License-Identifier: BSD-3-Clause
// offline diagnose: what the simulation gets wrong about a recording, and why.
#include <CLI/CLI.hpp>
#include <fstream>
#include <memory>

#include "raven_correction/correction/training.h"
#include "raven_correction/report/diagnosis_html.h"
#include "raven_correction/report/diagnosis_report.h"
#include "raven_correction/ros/command_record.h"
#include "raven_correction/ros/diagnosis_job.h"
#include "raven_correction/ros/offline.h"
#include "raven_correction/ros/session_bag.h"

namespace raven_correction {
namespace {

struct Arguments {
  std::vector<std::string> inputs;
  std::string simulation, output, report, hold_out;
  NumberFiles numbers;
  DiagnosisJob job;
};

void diagnoseInput(const Arguments& arguments) {
  checkOutputFile(arguments.output, false);
  checkNumberFiles(arguments.numbers);
  checkOutputFile(arguments.report, true);
  Dataset dataset = readInputs(arguments.inputs);
  if (!arguments.hold_out.empty())
    dataset = selectFold(dataset, parseHoldOut(arguments.hold_out), false);
  const std::string simulation_file = arguments.simulation.empty()
                                          ? packageFile("config/simulation/nominal.yaml")
                                          : arguments.simulation;
  const SimulationConfig simulation = loadSimulationConfig(simulation_file);
  DiagnosisJob job = arguments.job;
  job.output = arguments.output;
  const Verdict verdict = runDiagnosis(dataset, simulation, job, showProgress);
  showProgress("done", 1.0);
  std::fputs(diagnosisText(verdict).c_str(), stdout);
  writeNumbers(arguments.numbers, diagnosisJson(verdict));
  if (!arguments.report.empty()) {
    RunRecord run = recordRun(arguments.inputs);
    run.settings = {
        {"simulation", arguments.simulation.empty()
                           ? "config/simulation/nominal.yaml of the package"
                           : arguments.simulation},
        {"driven by", arguments.job.from},
        {"left out",
         arguments.hold_out.empty()
             ? arguments.job.leave_out_validation ? "what a trainer validates models on" : "nothing"
             : "fold " + arguments.hold_out},
        {"at most so many samples", job.options.recording.max_samples == 0
                                        ? "all"
                                        : std::to_string(job.options.recording.max_samples)}};
    std::ifstream file(simulation_file);
    run.configuration.assign(std::istreambuf_iterator<char>(file), {});
    writeTextFile(arguments.report,
                  diagnosisHtml(verdict, streamHealth(dataset), arguments.output, run));
  }
  if (arguments.output.empty()) return;
  saveSimulationConfig(verdict.simulation, arguments.output);
  std::printf("wrote %s\n", arguments.output.c_str());
}

}  // namespace

void addDiagnoseCommand(CLI::App& app) {
  const auto arguments = std::make_shared<Arguments>();
  CLI::App* const command = app.add_subcommand("diagnose",
                                               "What the simulation gets wrong about a recording: "
                                               "names the physical causes, and measures what "
                                               "they explain on motions held out");
  command->add_option("INPUT", arguments->inputs, "bags or data set directories")->required();
  command->add_option("--simulation", arguments->simulation,
                      "simulation file; default: config/simulation/nominal.yaml of the package");
  command->add_option("-o,--output", arguments->output, "extended simulation file to write");
  addNumberOptions(*command, arguments->numbers);
  command->add_option("--report", arguments->report,
                      "write the verdict as a page with figures (HTML, one file)");
  command
      ->add_option("--from", arguments->job.from,
                   "what drives the simulation: commands, or encoders (then only what lies behind "
                   "the motors is diagnosed)")
      ->check(CLI::IsMember({"commands", "encoders"}));
  command->add_flag("--ignore-encoders", arguments->job.ignore_encoders,
                    "encoder streams are no observations");
  command->add_option("--prismatic", arguments->job.prismatic,
                      "joint data: joints in metres, where dataset.yaml does not say so");
  command->add_option("--folds", arguments->job.options.selection.folds, "of the held-out motions")
      ->check(CLI::Range(2, 100));
  command
      ->add_option("--max-causes", arguments->job.options.selection.max_causes, "at most so many")
      ->check(CLI::Range(1, 1000));
  command
      ->add_option("--max-samples", arguments->job.options.recording.max_samples,
                   "observations used, evenly spread; 0: all")
      ->check(CLI::Range(0, 100000000));
  command->add_option("--hold-out", arguments->hold_out,
                      "K/N: leave out trajectory i where i % N == K (zero-based, by start time)");
  command->add_flag("--leave-out-validation", arguments->job.leave_out_validation,
                    "leave out the trajectories that a trainer validates models on, so that it can "
                    "judge a model with the extended simulation");
  command->add_option("--seed", arguments->job.options.selection.seed, "of the bootstrap");
  command->callback([arguments] { diagnoseInput(*arguments); });
}

}  // namespace raven_correction
