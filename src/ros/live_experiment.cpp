// SPDX-License-Identifier: BSD-3-Clause
#include "raven_correction/ros/live_experiment.h"

#include <CLI/CLI.hpp>
#include <atomic>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <stdexcept>

#include "raven_correction/error.h"
#include "raven_correction/ros/command_record.h"

namespace raven_correction {

namespace fs = std::filesystem;

namespace {

constexpr double kModelTimeout = 20.0;                   // [s, real]
constexpr char kController[] = "simulator: controller";  // ending of its name in /diagnostics

bool endsWith(const std::string& text, const std::string& ending) {
  return text.size() >= ending.size() &&
         text.compare(text.size() - ending.size(), ending.size(), ending) == 0;
}

/// Where the nodes write: `output`, made if need be, or a temporary folder.
std::string folderOf(const std::string& experiment, const std::string& output) {
  if (output.empty()) {
    std::string name = fs::temp_directory_path() / ("raven_correction_" + experiment + "_XXXXXX");
    if (mkdtemp(name.data()) == nullptr)
      throw InvalidInput(format("%s: cannot be made; set --output", name.c_str()));
    return name;
  }
  fs::create_directories(output);
  if (!fs::is_empty(output))
    throw InvalidInput(
        format("%s: is not empty; nothing was written, choose another folder", output.c_str()));
  return output;
}

}  // namespace

void addLiveFiles(CLI::App& command, LiveFiles& files, const std::string& kept) {
  command.add_option("--output", files.output,
                     "keep " + kept + " and log in this folder (empty or new)");
  addNumberOptions(command, files.numbers);
  command.add_option("--report", files.report, "write a page with figures (HTML, one file)");
}

void runLiveExperiment(
    const std::string& name, const LiveFiles& files,
    const std::function<LiveResult(const std::string& folder, const std::string& shown)>& run) {
  checkNumberFiles(files.numbers);
  checkOutputFile(files.report, true);
  const std::string folder = folderOf(name, files.output);
  const LiveResult result = run(folder, files.output.empty() ? "" : folder);
  writeNumbers(files.numbers, result.json);
  std::fputs(result.text.c_str(), stdout);
  if (!files.report.empty()) {
    RunRecord record = recordRun({});
    record.settings = result.settings;
    writeTextFile(files.report, result.html(record));
  }
  if (files.output.empty()) fs::remove_all(folder);
}

void waitForModel(const std::string& corrector, const std::string& model, PrivateLaunch& launch) {
  std::atomic<bool> in_use{false};
  const std::string node = corrector.substr(corrector.find_first_not_of('/'));
  ros::NodeHandle nh;
  const ros::Subscriber subscriber = nh.subscribe<diagnostic_msgs::DiagnosticArray>(
      "/diagnostics", 100, [&](const diagnostic_msgs::DiagnosticArrayConstPtr& message) {
        for (const diagnostic_msgs::DiagnosticStatus& status : message->status)
          for (const diagnostic_msgs::KeyValue& value : status.values)
            if (status.name.find(node) != std::string::npos && value.key == "model" &&
                value.value == model)
              in_use = true;
      });
  const ros::SteadyTime deadline = ros::SteadyTime::now() + ros::WallDuration(kModelTimeout);
  while (!in_use) {
    launch.requireAlive();
    if (ros::SteadyTime::now() > deadline)
      throw std::runtime_error(
          format("%s did not take model %s into use", corrector.c_str(), model.c_str()));
    ros::WallDuration(0.05).sleep();
  }
}

SimulatorCycles::SimulatorCycles()
    : subscriber_(ros::NodeHandle().subscribe<diagnostic_msgs::DiagnosticArray>(
          "/diagnostics", 100, [this](const diagnostic_msgs::DiagnosticArrayConstPtr& message) {
            onDiagnostics(*message);
          })) {}

void SimulatorCycles::onDiagnostics(const diagnostic_msgs::DiagnosticArray& message) {
  const std::lock_guard<std::mutex> lock(mutex_);
  for (const diagnostic_msgs::DiagnosticStatus& status : message.status) {
    if (!endsWith(status.name, kController)) continue;
    for (const diagnostic_msgs::KeyValue& value : status.values) {
      if (value.key == "cycles") total_ = std::strtoull(value.value.c_str(), nullptr, 10);
      if (value.key == "late cycles") late_ = std::strtoull(value.value.c_str(), nullptr, 10);
    }
  }
}

std::uint64_t SimulatorCycles::total() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return total_;
}

std::uint64_t SimulatorCycles::late() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return late_;
}

}  // namespace raven_correction
