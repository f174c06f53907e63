// SPDX-License-Identifier: BSD-3-Clause
#include "raven_correction/dataset/stream_health.h"

#include <gtest/gtest.h>

#include <cmath>

namespace raven_correction {
namespace {

TEST(StreamHealth, CountsRatesGapsAndRepeatedFrames) {
  Dataset dataset;
  for (int k = 0; k < 2; ++k) {
    Trajectory trajectory;
    trajectory.id = "t" + std::to_string(k);
    for (int i = 0; i <= 100; ++i) {
      StampedPose sample;
      sample.stamp = 10.0 * k + 0.01 * i + (i > 50 && k == 1 ? 0.5 : 0.0);  // one gap of 0.51 s
      sample.pose.p.x() = i;
      trajectory.observations.push_back(sample);
      sample.pose.p.x() = 1.0;  // a robot at rest
      trajectory.commands.push_back(sample);
    }
    dataset.trajectories.push_back(trajectory);
  }
  dataset.trajectories[0].observations[7] = dataset.trajectories[0].observations[6];
  dataset.trajectories[0].observations[9].pose.p.y() = std::nan("");
  const std::vector<StreamHealth> all = streamHealth(dataset);
  ASSERT_EQ(all.size(), 2u);
  EXPECT_EQ(all[0].stream, "commands");
  EXPECT_EQ(all[0].repeated, 0u);
  const StreamHealth& seen = all[1];
  EXPECT_EQ(seen.stream, "observations");
  EXPECT_EQ(seen.trajectories, 2u);
  EXPECT_EQ(seen.samples, 202u);
  EXPECT_EQ(seen.repeated, 1u);
  EXPECT_EQ(seen.not_finite, 1u);
  EXPECT_NEAR(seen.period_median, 0.01, 1e-9);
  EXPECT_NEAR(seen.longest_gap, 0.51, 1e-9);
  EXPECT_EQ(seen.longest_in, "t1");
  EXPECT_NEAR(seen.duration, 2.5, 1e-9);
  EXPECT_NEAR(seen.gap_share, 0.51 / 2.5, 1e-6);
}

TEST(StreamHealth, OfNothingIsNothing) { EXPECT_TRUE(streamHealth(Dataset()).empty()); }

}  // namespace
}  // namespace raven_correction
