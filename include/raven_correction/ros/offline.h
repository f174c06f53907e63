// SPDX-License-Identifier: BSD-3-Clause
// The offline command line: the same library without a ROS master. One file per command; this
// header is what they share.
#pragma once

#include <CLI/App.hpp>
#include <string>
#include <vector>

#include "raven_correction/ros/session_bag.h"

namespace raven_correction {

/// Each adds one subcommand with its options and its action to the program.
void addImportExportCommands(CLI::App& app);
void addSimulateCommand(CLI::App& app);
void addTrainCommand(CLI::App& app);
void addPredictCommand(CLI::App& app);
void addEvaluateCommand(CLI::App& app);
void addCompareCommand(CLI::App& app);
void addDiagnoseCommand(CLI::App& app);
void addRegressCommand(CLI::App& app);
void addExperimentCommand(CLI::App& app);
/// Likewise, of the command `experiment`.
void addRepeatabilityExperiment(CLI::App& experiment);
void addFragmentsExperiment(CLI::App& experiment);
void addFigureExperiments(CLI::App& experiment);

/// Options of readTrusted().
void addCheckOptions(CLI::App& command, std::vector<std::string>& robots, bool& ignore);

/// All commands. Text goes to standard output, progress and errors to standard error.
/// @return 0 on success, 2 on bad usage or bad input (the text says why), 1 on failure
int runOffline(int argc, char** argv);

/// A file that the package ships, e.g. "config/trainer.yaml".
/// @throws InvalidInput  the package is not on ROS_PACKAGE_PATH, or the file is missing
std::string packageFile(const std::string& relative);

/// Refuses at once what would only fail after a long computation.
/// @throws InvalidInput  the file exists (unless `overwrite`), or its folder does not
void checkOutputFile(const std::string& file, bool overwrite);
/// @throws InvalidInput  cannot be written
void writeTextFile(const std::string& file, const std::string& text);

/// Where a command writes its numbers; empty: nowhere.
struct NumberFiles {
  std::string json, csv;
};
/// --json and --csv.
void addNumberOptions(CLI::App& command, NumberFiles& files);
/// checkOutputFile() of both, which may exist.
void checkNumberFiles(const NumberFiles& files);
/// The same numbers in each: csvOfJson(). @throws InvalidInput  cannot be written
void writeNumbers(const NumberFiles& files, const std::string& json);

/// Inputs whose streams have been checked: findings go to standard error.
/// @param robots  file of the arm's chain, then those of arms it may be mixed up with; may be empty
/// @param ignore  errors do not stop it
/// @throws InvalidInput  there is an error among the findings; see readCheckedInputs(), loadArms()
CheckedInputs readTrusted(const std::vector<std::string>& inputs,
                          const std::vector<std::string>& robots, bool ignore);

/// Progress on standard error: one line that is rewritten on a terminal, a line per change of phase
/// elsewhere. Silent when `phase` is empty.
void showProgress(const std::string& phase, double fraction);

}  // namespace raven_correction
