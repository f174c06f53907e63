// SPDX-License-Identifier: BSD-3-Clause
// Nodes on a ROS master of their own: roslaunch as a child process on a free port, for experiments
// that shall not meet a robot. Everything in it ends with the object, with Ctrl-C, and with this
// process, however that ends.
#pragma once

#include <sys/types.h>

#include <string>
#include <vector>

namespace raven_correction {

class PrivateLaunch {
 public:
  /// Starts roslaunch in a session of its own, and makes this process a node of its master. One at
  /// a time in a process, and none after ros::init(): the environment and the name of the process
  /// change.
  /// @param arguments  of roslaunch: package, file, NAME:=VALUE...
  /// @param folder     for the nodes' log (nodes.log) and ROS_HOME; exists
  /// @param node       name of this process, made unique
  /// @param timeout    for the master to answer [s, real]
  /// @throws std::runtime_error  see requireAlive()
  PrivateLaunch(const std::vector<std::string>& arguments, const std::string& folder,
                const std::string& node, double timeout = 60.0);
  /// Asks roslaunch to end, waits, and then insists. Returns when no process of it is left.
  ~PrivateLaunch();
  PrivateLaunch(const PrivateLaunch&) = delete;
  PrivateLaunch& operator=(const PrivateLaunch&) = delete;

  /// @throws std::runtime_error  roslaunch has ended (the text has the end of the log), or this
  ///         process was asked to end
  void requireAlive();
  /// Returns when all these services are there.
  /// @throws std::runtime_error  see requireAlive(); or one is missing after `timeout` [s, real]
  void waitForServices(const std::vector<std::string>& names, double timeout = 60.0);

 private:
  void start(const std::vector<std::string>& arguments, const std::string& folder);
  void end() noexcept;

  std::string log_;
  pid_t pid_ = -1;  // of roslaunch, and of its session
};

}  // namespace raven_correction
