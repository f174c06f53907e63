// SPDX-License-Identifier: BSD-3-Clause
// Real-time priority of threads (SCHED_FIFO, sched(7)): what is not under it waits while one of
// them has something to do, on the processor where it runs.
#pragma once

#include <ros/callback_queue_interface.h>

#include <functional>
#include <string>

namespace raven_correction {

/// Above that are the handlers of interrupts, without which nothing is received.
constexpr int kHighestRealtimePriority = 49;

/// Of the calling thread. Threads that it starts do not inherit it.
/// @param priority  1 to kHighestRealtimePriority
/// @return empty; or why the system refuses, and what allows it: all stays as it was
std::string takeRealtimePriority(int priority);

/// Of roscpp's thread that reads and writes the sockets of this process, all of them. Waits until
/// it has it, 0.1 s as a rule.
/// @param priority, @return  as for takeRealtimePriority()
std::string giveSocketsRealtimePriority(int priority);

/// What the thread of a queue does before anything else, such as to take a priority. To be called
/// before the queue gets callbacks and is spun, by one thread.
void doFirst(ros::CallbackQueueInterface& queue, std::function<void()> action);

}  // namespace raven_correction
