// SPDX-License-Identifier: BSD-3-Clause
// offline import, offline export: data set directory to bag and back.
#include <CLI/CLI.hpp>
#include <memory>

#include "raven_correction/dataset/dataset_directory.h"
#include "raven_correction/error.h"
#include "raven_correction/ros/offline.h"
#include "raven_correction/ros/session_bag.h"

namespace raven_correction {
namespace {

struct Arguments {
  std::string input, output;
};

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
  const auto import_arguments = std::make_shared<Arguments>();
  CLI::App* const import_command =
      app.add_subcommand("import", "Writes a data set directory as a bag");
  import_command->add_option("DIR", import_arguments->input, "data set directory")->required();
  import_command->add_option("-o,--output", import_arguments->output, "bag to write")->required();
  import_command->callback([import_arguments] {
    checkOutputFile(import_arguments->output, false);
    const Dataset dataset = readDatasetDirectory(import_arguments->input);
    writeSessionBag(dataset, import_arguments->output);
    summary(dataset, import_arguments->output);
  });

  const auto export_arguments = std::make_shared<Arguments>();
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
