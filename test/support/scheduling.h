// SPDX-License-Identifier: BSD-3-Clause
// How the threads of this process are scheduled.
#pragma once

#include <sched.h>

#include <filesystem>
#include <fstream>
#include <string>
#include <utility>
#include <vector>

namespace raven_correction {

using RealtimeThreads = std::vector<std::pair<std::string, int>>;

/// Names and priorities of those under SCHED_FIFO. One that has been joined may be there for a
/// moment.
inline RealtimeThreads realtimeThreads() {
  RealtimeThreads threads;
  for (const auto& task : std::filesystem::directory_iterator("/proc/self/task")) {
    const pid_t thread = std::stoi(task.path().filename().string());
    std::string name;
    std::getline(std::ifstream(task.path() / "comm"), name);
    sched_param parameters{};
    if ((sched_getscheduler(thread) & ~SCHED_RESET_ON_FORK) == SCHED_FIFO &&
        sched_getparam(thread, &parameters) == 0)
      threads.emplace_back(name, parameters.sched_priority);
  }
  return threads;
}

}  // namespace raven_correction
