// SPDX-License-Identifier: BSD-3-Clause
// Real-time priority of a thread: taken where the system allows it, and a refusal says what would.
// Those of a corrector are test/nodes/corrector_nodelet.cpp and corrector_processes.py.
#include "raven_correction/ros/realtime.h"

#include <gtest/gtest.h>
#include <linux/capability.h>
#include <pthread.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <iostream>
#include <thread>

#include "support/scheduling.h"

namespace raven_correction {
namespace {

TEST(Realtime, OfTheThreadThatAsksAndOfNoneThatItStarts) {
  std::string refusal;
  std::thread([&] {
    pthread_setname_np(pthread_self(), "asks");
    refusal = takeRealtimePriority(7);
    const RealtimeThreads expected(refusal.empty() ? 1 : 0, {"asks", 7});
    EXPECT_EQ(realtimeThreads(), expected);
    std::thread([&] { EXPECT_EQ(realtimeThreads(), expected); }).join();
  }).join();
  if (!refusal.empty()) GTEST_SKIP() << refusal;
}

/// Asks as somebody to whom the system allows nothing.
[[noreturn]] void askInVain() {
  const rlimit none{0, 0};
  setrlimit(RLIMIT_RTPRIO, &none);
  __user_cap_header_struct header{_LINUX_CAPABILITY_VERSION_3, 0};
  __user_cap_data_struct no_capabilities[2]{};
  if (syscall(SYS_capset, &header, no_capabilities) != 0) _exit(2);
  std::cerr << takeRealtimePriority(7);
  _exit(realtimeThreads().empty() ? 0 : 1);
}

TEST(Realtime, ARefusalSaysWhatWouldAllowIt) {
  EXPECT_EXIT(askInVain(), ::testing::ExitedWithCode(0),
              "no real-time priority 7: Operation not permitted; .*rtprio.*SYS_NICE");
}

TEST(Realtime, AnImpossiblePriorityIsRefused) {
  std::thread([] {
    EXPECT_NE(takeRealtimePriority(100).find("Invalid argument"), std::string::npos);
  }).join();
}

TEST(Realtime, WithoutRoscppThereIsNothingToRaise) {
  EXPECT_NE(giveSocketsRealtimePriority(7).find("ros::start"), std::string::npos);
}

}  // namespace
}  // namespace raven_correction
