// SPDX-License-Identifier: BSD-3-Clause
// What the node adds to the live path around the correction: reading and writing a command,
// messages from a pool, percentiles of the latency. None of it allocates.
#include <gtest/gtest.h>

#include <memory>
#include <set>

#include "raven_correction/ros/arm_observer.h"
#include "raven_correction/ros/latency_histogram.h"
#include "raven_correction/ros/message_pool.h"
#include "raven_correction/ros/pose_command.h"
#include "support/allocation_guard.h"
#include "support/raven_bytes.h"

namespace raven_correction {
namespace {

TEST(MessagePool, GivesWhatNobodyHoldsAndTheLivePathDoesNotAllocate) {
  MessagePool<RavenCommand> pool;
  RavenCommand message;
  message.bytes = command({"L", "R"});
  const std::vector<std::string> arms{"L", "R"};
  CommandRequest request;
  LatencyHistogram latency;
  const auto handle = [&] {
    readCommand(message, arms, request);
    const boost::shared_ptr<RavenCommand> changed = pool.next();
    *changed = message;
    for (const ArmRequest& arm : request.arms) writeCommand(*changed, arm, Pose());
    latency.add(1e-5);
  };
  for (int i = 0; i < 20; ++i) handle();  // every message of the pool has had its size once
  {
    const AllocationGuard guard;
    for (int i = 0; i < 100; ++i) handle();
    EXPECT_EQ(guard.count(), 0);
  }
  std::set<RavenCommand*> held;
  std::vector<boost::shared_ptr<RavenCommand>> holders;
  for (int i = 0; i < 50; ++i) {
    holders.push_back(pool.next());
    EXPECT_TRUE(held.insert(holders.back().get()).second) << i;
  }
}

TEST(LiveQueue, TakesSamplesWithoutAllocationAndLeavesOutWhatFindsNoRoom) {
  const auto queue = std::make_unique<LiveQueue>();
  LiveSample sample;
  std::size_t taken = 0;
  {
    const AllocationGuard guard;
    for (int i = 0; i < 5000; ++i) {
      sample.stamp = i;
      sample.setFrame("a_frame_whose_name_is_longer_than_there_is_room_for_in_a_sample");
      taken += queue->push(sample) ? 1 : 0;
    }
    EXPECT_EQ(guard.count(), 0);
  }
  EXPECT_EQ(taken, 4096u);
  ASSERT_TRUE(queue->pop(sample));
  EXPECT_EQ(sample.stamp, 0.0) << "the oldest first";
  EXPECT_EQ(std::string(sample.frame.data()).size(), sample.frame.size() - 1);
}

TEST(LatencyHistogram, PercentilesAreRightToTheWidthOfTheirClass) {
  LatencyHistogram latency;
  EXPECT_EQ(latency.take().count, 0u);
  for (int i = 1; i <= 1000; ++i) latency.add(1e-6 * i);
  const LatencyHistogram::Snapshot snapshot = latency.take();
  EXPECT_EQ(snapshot.count, 1000u);
  EXPECT_NEAR(snapshot.p50, 500e-6, 0.1 * 500e-6);
  EXPECT_NEAR(snapshot.p99, 990e-6, 0.1 * 990e-6);
  EXPECT_EQ(snapshot.max, 1e-3);
  EXPECT_EQ(latency.take().count, 0u);  // since the last look
}

}  // namespace
}  // namespace raven_correction
