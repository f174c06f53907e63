// SPDX-License-Identifier: BSD-3-Clause
// offline import, offline export: data set directory or MATLAB recordings to bag, and bag to
// directory.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <memory>

#include "raven_correction/dataset/dataset_directory.h"
#include "raven_correction/dataset/mat_recordings.h"
#include "raven_correction/error.h"
#include "raven_correction/ros/offline.h"
#include "raven_correction/ros/session_bag.h"

namespace raven_correction {
namespace {

struct ImportArguments {
  std::vector<std::string> inputs;
  std::string output, frame = "0_link";
};
struct ExportArguments {
  std::string input, output;
};

Dataset readForeign(const ImportArguments& arguments) {
  const std::vector<std::string>& inputs = arguments.inputs;
  if (std::any_of(inputs.begin(), inputs.end(), holdsMatRecordings))
    return readMatRecordings(inputs, arguments.frame);
  if (inputs.size() > 1)
    throw InvalidInput(
        format("%zu inputs; import takes one data set directory, or *.mat files and "
               "directories of them",
               inputs.size()));
  return readDatasetDirectory(inputs.front());
}

void summary(const Dataset& dataset, const std::string& output) {
  std::size_t commands = 0, observations = 0, encoders = 0;
  for (const Trajectory& trajectory : dataset.trajectories) {
    commands += trajectory.commands.size();
    observations += trajectory.observations.size();
    encoders += trajectory.encoders.size();
  }
  std::printf("%s: %zu trajectories, %zu commands, %zu observations, %zu encoder poses\n",
              output.c_str(), dataset.trajectories.size(), commands, observations, encoders);
}

}  // namespace

void addImportExportCommands(CLI::App& app) {
  const auto import_arguments = std::make_shared<ImportArguments>();
  CLI::App* const import_command = app.add_subcommand(
      "import",
      "Writes a data set directory, or the MATLAB recordings of the paper's authors, as a bag");
  import_command
      ->add_option("INPUT", import_arguments->inputs,
                   "data set directory, or *.mat files and directories of them")
      ->required();
  import_command->add_option("-o,--output", import_arguments->output, "bag to write")->required();
  import_command
      ->add_option("--frame", import_arguments->frame,
                   "frame of the poses in *.mat files, which do not say it")
      ->capture_default_str();
  import_command->callback([import_arguments] {
    checkOutputFile(import_arguments->output, false);
    const Dataset dataset = readForeign(*import_arguments);
    writeSessionBag(dataset, import_arguments->output);
    summary(dataset, import_arguments->output);
  });

  const auto export_arguments = std::make_shared<ExportArguments>();
  CLI::App* const export_command =
      app.add_subcommand("export", "Writes a bag as a data set directory");
  export_command->add_option("BAG", export_arguments->input, "recorded session")->required();
  export_command->add_option("-o,--output", export_arguments->output, "directory to write")
      ->required();
  export_command->callback([export_arguments] {
    const Dataset dataset = readSessionBag(export_arguments->input).dataset;
    writeDatasetDirectory(dataset, export_arguments->output);
    summary(dataset, export_arguments->output);
  });
}

}  // namespace raven_correction
