// SPDX-License-Identifier: BSD-3-Clause
// How the threads of this process are scheduled.
#pragma once

#include <sched.h>

#include <filesystem>
#include <string>
#include <vector>

namespace raven_correction {

/// Priorities of those under SCHED_FIFO.
inline std::vector<int> realtimePriorities() {
  std::vector<int> priorities;
  for (const auto& task : std::filesystem::directory_iterator("/proc/self/task")) {
    const pid_t thread = std::stoi(task.path().filename().string());
    sched_param parameters{};
    if ((sched_getscheduler(thread) & ~SCHED_RESET_ON_FORK) == SCHED_FIFO &&
        sched_getparam(thread, &parameters) == 0)
      priorities.push_back(parameters.sched_priority);
  }
  return priorities;
}

}  // namespace raven_correction
