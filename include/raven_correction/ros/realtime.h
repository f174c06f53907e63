// SPDX-License-Identifier: BSD-3-Clause
// A thread that goes before all others of the machine.
#pragma once

#include <string>

namespace raven_correction {

constexpr int kLowestRealtimePriority = 1, kHighestRealtimePriority = 99;

/// Puts the calling thread under SCHED_FIFO (sched(7)): whatever is not under it waits while this
/// thread has something to do. Threads that it starts do not inherit that.
/// @param priority  kLowestRealtimePriority to kHighestRealtimePriority
/// @return empty; or why the system refuses, and what allows it: all stays as it was
std::string takeRealtimePriority(int priority);

}  // namespace raven_correction
