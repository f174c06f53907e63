// SPDX-License-Identifier: BSD-3-Clause
#include "raven_correction/ros/realtime.h"

#include <pthread.h>
#include <sched.h>

#include <cerrno>
#include <cstring>

#include "raven_correction/error.h"

namespace raven_correction {

std::string takeRealtimePriority(int priority) {
  sched_param parameters{};
  parameters.sched_priority = priority;
  const int error =
      pthread_setschedparam(pthread_self(), SCHED_FIFO | SCHED_RESET_ON_FORK, &parameters);
  if (error == 0) return "";
  const std::string remedy =
      error == EPERM ? format(
                           "; \"USER - rtprio %d\" in /etc/security/limits.conf and a new login "
                           "allow it, in a container the capability SYS_NICE",
                           priority)
                     : "";
  return format("no real-time priority %d: %s%s", priority, std::strerror(error), remedy.c_str());
}

}  // namespace raven_correction
