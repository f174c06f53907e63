// SPDX-License-Identifier: BSD-3-Clause
#include "raven_correction/ros/offline.h"

#include <ros/package.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <filesystem>
#include <fstream>

#include "raven_correction/error.h"
#include "raven_correction/report/number_table.h"
#include "raven_correction/ros/arm_kinematics.h"
#include "raven_correction/ros/command_record.h"

namespace raven_correction {

namespace fs = std::filesystem;

std::string packageFile(const std::string& relative) {
  const std::string package = ros::package::getPath("raven_correction");
  if (package.empty())
    throw InvalidInput(
        format("the package raven_correction is not found, so its %s is not; set "
               "ROS_PACKAGE_PATH (./run offline does), or name the file yourself",
               relative.c_str()));
  const std::string file = package + "/" + relative;
  if (!fs::exists(file)) throw InvalidInput(format("%s: missing", file.c_str()));
  return file;
}

void checkOutputFile(const std::string& file, bool overwrite) {
  if (file.empty()) return;
  if (!overwrite && fs::exists(file))
    throw InvalidInput(
        format("%s: exists; nothing was written, choose another name or remove it", file.c_str()));
  const fs::path folder = fs::path(file).parent_path();
  if (!folder.empty() && !fs::is_directory(folder))
    throw InvalidInput(format("%s: no such directory", folder.string().c_str()));
}

void writeTextFile(const std::string& file, const std::string& text) {
  std::ofstream out(file);
  out << text;
  out.close();
  if (!out) throw InvalidInput(format("%s: cannot be written", file.c_str()));
}

void addNumberOptions(CLI::App& command, NumberFiles& files) {
  command.add_option("--json", files.json, "write the numbers as JSON");
  command.add_option("--csv", files.csv, "write the same numbers as a table (CSV)");
}

void checkNumberFiles(const NumberFiles& files) {
  checkOutputFile(files.json, true);
  checkOutputFile(files.csv, true);
}

void writeNumbers(const NumberFiles& files, const std::string& json) {
  if (!files.json.empty()) writeTextFile(files.json, json);
  if (!files.csv.empty()) writeTextFile(files.csv, csvOfJson(json));
}

CheckedInputs readTrusted(const std::vector<std::string>& inputs,
                          const std::vector<std::string>& robots, bool ignore) {
  std::vector<ArmKinematics> arms;
  if (!robots.empty()) arms = loadArms(robots.front(), {robots.begin() + 1, robots.end()}, "");
  CheckedInputs checked = readCheckedInputs(inputs, arms);
  if (!ignore) refuseErrors(checked.dataset.source, checked.findings, "--ignore-checks");
  for (const StreamFinding& finding : checked.findings)
    std::fprintf(stderr, "%s\n", toText(finding).c_str());
  return checked;
}

void addCheckOptions(CLI::App& command, std::vector<std::string>& robots, bool& ignore) {
  command
      .add_option("--robot", robots,
                  "chain of the arm (config/robots), then, given again, of each arm that it may be "
                  "mixed up with: its joints are held against its encoders")
      ->allow_extra_args(false);
  command.add_flag("--ignore-checks", ignore,
                   "go on although the checks of the streams find errors");
}

void showProgress(const std::string& phase, double fraction) {
  if (phase.empty()) return;
  if (isatty(STDERR_FILENO)) {
    std::fprintf(stderr, "\r\033[K%3.0f %%  %s%s", 100.0 * fraction, phase.c_str(),
                 fraction >= 1.0 ? "\n" : "");
  } else {
    static std::string last;
    if (phase != last) std::fprintf(stderr, "%3.0f %%  %s\n", 100.0 * fraction, phase.c_str());
    last = phase;
  }
  std::fflush(stderr);
}

int runOffline(int argc, char** argv) {
  setCommandLine(argc, argv);
  CLI::App app(
      "raven_correction without a ROS master. INPUT is a bag or a data set directory.\n"
      "Exit code: 0 success, 2 bad usage or bad input, 1 failure.");
  app.name("offline");
  app.require_subcommand(1);
  addImportExportCommands(app);
  addSimulateCommand(app);
  addTrainCommand(app);
  addPredictCommand(app);
  addEvaluateCommand(app);
  addCompareCommand(app);
  addDiagnoseCommand(app);
  addRegressCommand(app);
  addExperimentCommand(app);
  if (argc > 1 && argv[1][0] != '-') {
    bool known = false;
    std::string names;
    for (const CLI::App* const command : app.get_subcommands([](CLI::App*) { return true; })) {
      known |= command->check_name(argv[1]);
      names += (names.empty() ? "" : ", ") + command->get_name();
    }
    if (!known) {
      std::fprintf(stderr, "offline: there is no command %s; these are: %s\n", argv[1],
                   names.c_str());
      return 2;
    }
  }
  try {
    app.parse(argc, argv);
    return 0;
  } catch (const CLI::RuntimeError& error) {
    return error.get_exit_code();
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;  // --help ends here, too
  } catch (const InvalidInput& error) {
    std::fprintf(stderr, "offline: %s\n", error.what());
    return 2;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "offline: failed: %s\n", error.what());
    return 1;
  }
}

}  // namespace raven_correction
