// SPDX-License-Identifier: BSD-3-Clause
// What the experiments share that start nodes on a ROS master of their own (private_launch.h).
#pragma once

#include <diagnostic_msgs/DiagnosticArray.h>
#include <ros/ros.h>

#include <CLI/App.hpp>
#include <cstdint>
#include <functional>
#include <mutex>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "raven_correction/report/run_record.h"
#include "raven_correction/ros/offline.h"
#include "raven_correction/ros/private_launch.h"

namespace raven_correction {

/// Adds its subcommand to the command `experiment`, as those of offline.h.
void addDebridementExperiment(CLI::App& experiment);

/// What a live experiment writes, as the options of its command say.
struct LiveFiles {
  std::string output;  ///< folder of what the nodes write; empty: it is not kept
  std::string report;  ///< page with figures; empty: none
  NumberFiles numbers;
};
/// Adds --output, --report and those of addNumberOptions().
/// @param kept  what the nodes write, for --help
void addLiveFiles(CLI::App& command, LiveFiles& files, const std::string& kept);

/// The result of a live experiment, for people, programs and browsers.
struct LiveResult {
  std::string text, json;
  std::function<std::string(const RunRecord&)> html;
  std::vector<std::pair<std::string, std::string>> settings;  ///< of the run, for its page
};
/// Runs one and writes its result; nothing begins where a file could not be written in the end.
/// @param name  of the subcommand
/// @param run   is given the folder of the nodes, and how the result calls it: empty if it is not
///              kept. Where none is asked for it is a temporary one, which stays, with the nodes'
///              log, if the experiment fails
/// @throws InvalidInput  a file or folder that cannot be written, or the folder is not empty; and
///         what `run` throws
void runLiveExperiment(
    const std::string& name, const LiveFiles& files,
    const std::function<LiveResult(const std::string& folder, const std::string& shown)>& run);

/// Returns when the corrector says in /diagnostics that it uses this model. A model that is live at
/// the trainer is still on its way, and the corrector passes on what comes before it as it is.
/// @param corrector  resolved name of the node
/// @throws std::runtime_error  it does not say so within 20 s (real), or the nodes have ended
void waitForModel(const std::string& corrector, const std::string& model, PrivateLaunch& launch);

/// Calls a service of one of the nodes.
/// @param name  resolved
/// @throws std::runtime_error  the nodes have ended, it did not answer, or it says that it did not
///         succeed
template <typename Service>
typename Service::Response callNode(PrivateLaunch& launch, const std::string& name,
                                    const typename Service::Request& request) {
  typename Service::Response response;
  const bool answered = ros::service::call(name, request, response);
  launch.requireAlive();
  if (!answered) throw std::runtime_error(name + " did not answer");
  if (!response.success) throw std::runtime_error(name + ": " + response.message);
  return response;
}

/// What the simulator says of its cycles in /diagnostics: whether the machine kept up. Thread-safe;
/// needs somebody who spins.
class SimulatorCycles {
 public:
  SimulatorCycles();
  std::uint64_t total() const;
  std::uint64_t late() const;

 private:
  void onDiagnostics(const diagnostic_msgs::DiagnosticArray& message);

  mutable std::mutex mutex_;  // guards what follows
  std::uint64_t total_ = 0, late_ = 0;
  ros::Subscriber subscriber_;  // last: its callback uses all of the above
};

}  // namespace raven_correction
