// SPDX-License-Identifier: BSD-3-Clause
// A ROS master for one benchmark, on a free port, and the processes that it starts: all of them end
// with the program, however it ends.
#pragma once

#include <ros/ros.h>
#include <sys/types.h>

#include <filesystem>
#include <map>
#include <stdexcept>
#include <string>
#include <vector>

namespace raven_correction {
namespace bench {

/// Asks every 10 ms. @throws std::runtime_error  after 30 s
template <typename Condition>
void waitUntil(Condition condition, const std::string& what) {
  const ros::SteadyTime end = ros::SteadyTime::now() + ros::WallDuration(30.0);
  while (!condition()) {
    if (ros::SteadyTime::now() > end) throw std::runtime_error("waited 30 s for " + what);
    ros::WallDuration(0.01).sleep();
  }
}

class OwnMaster {
 public:
  /// Starts the master and makes this process a node of it.
  explicit OwnMaster(const std::string& node_name);
  ~OwnMaster();
  OwnMaster(const OwnMaster&) = delete;
  OwnMaster& operator=(const OwnMaster&) = delete;

  /// What it says goes to folder()/NAME.log.
  pid_t start(const std::string& name, const std::vector<std::string>& command);
  /// A node of the package, /NS/NODE.
  pid_t startNode(const std::string& node, const std::string& ns);
  /// @throws std::runtime_error  one of the processes has ended; with the last lines of what it
  /// said
  void checkAlive();
  /// Removed in the end unless the program failed.
  const std::filesystem::path& folder() const { return folder_; }
  void keepFolder() { keep_ = true; }

 private:
  std::filesystem::path folder_;
  std::map<std::string, pid_t> children_;
  bool keep_ = false;
};

/// The real-time priority that the two threads on the way of a pose have; 0: one of them has none.
int realtimePriority(pid_t process);

/// Processor time of a process since its start [s].
double processorTime(pid_t process);

}  // namespace bench
}  // namespace raven_correction
