// SPDX-License-Identifier: BSD-3-Clause
// Real-time priority of a thread: taken where the system allows it, and a refusal says what would.
#include "raven_correction/ros/realtime.h"

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <unistd.h>

#include <cstdlib>
#include <iostream>
#include <thread>

#include "support/scheduling.h"

namespace raven_correction {
namespace {

using Priorities = std::vector<int>;

TEST(Realtime, OfTheThreadThatAsksAndOfNoneThatItStarts) {
  std::thread([] {
    const std::string refusal = takeRealtimePriority(7);
    if (!refusal.empty()) {
      EXPECT_EQ(realtimePriorities(), Priorities()) << refusal;
      return;
    }
    EXPECT_EQ(realtimePriorities(), Priorities({7}));
    std::thread([] { EXPECT_EQ(realtimePriorities(), Priorities({7})); }).join();
  }).join();
}

/// Asks as somebody to whom the system allows nothing; exit code 0 if nothing was taken.
[[noreturn]] void askInVain() {
  const rlimit none{0, 0};
  setrlimit(RLIMIT_RTPRIO, &none);
  if (getuid() == 0 && setuid(65534) != 0) std::exit(2);
  std::cerr << takeRealtimePriority(7);
  std::exit(realtimePriorities().empty() ? 0 : 1);
}

TEST(Realtime, ARefusalSaysWhatWouldAllowIt) {
  EXPECT_EXIT(askInVain(), ::testing::ExitedWithCode(0),
              "no real-time priority 7: Operation not permitted; .*rtprio 7.*SYS_NICE");
}

TEST(Realtime, AnImpossiblePriorityIsRefused) {
  std::thread([] {
    EXPECT_NE(takeRealtimePriority(kHighestRealtimePriority + 1).find("Invalid argument"),
              std::string::npos);
  }).join();
}

}  // namespace
}  // namespace raven_correction
