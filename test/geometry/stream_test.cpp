// SPDX-License-Identifier: BSD-3-Clause
#include "raven_correction/geometry/stream.h"

#include <gtest/gtest.h>

#include "raven_correction/error.h"
#include "raven_correction/geometry/statistics.h"

namespace raven_correction {
namespace {

PoseStream line(const std::vector<double>& stamps) {
  PoseStream stream;
  for (const double t : stamps) stream.push_back({t, {{t, 0, 0}, expRotation({0, 0, 0.5 * t})}});
  return stream;
}

TEST(PoseAt, InterpolatesInsideAndNowhereElse) {
  const PoseStream stream = line({1.0, 1.1, 1.2, 2.0});
  const auto between = poseAt(stream, 1.15, 0.5);
  ASSERT_TRUE(between.has_value());
  EXPECT_NEAR(between->p.x(), 1.15, 1e-15);
  EXPECT_NEAR(logRotation(between->q).z(), 0.575, 1e-15);
  EXPECT_FALSE(poseAt(stream, 0.999, 0.5).has_value());
  EXPECT_FALSE(poseAt(stream, 2.001, 0.5).has_value());
  EXPECT_FALSE(poseAt(stream, 1.5, 0.5).has_value());  // inside the long interval
  EXPECT_TRUE(poseAt(stream, 1.5, 1.0).has_value());
  EXPECT_TRUE(poseAt(stream, 2.0, 0.5).has_value());  // a sample is always known
  EXPECT_FALSE(poseAt({}, 1.0, 0.5).has_value());
}

TEST(MedianPeriod, IgnoresRepeatedStamps) {
  EXPECT_DOUBLE_EQ(medianPeriod(line({0.0, 0.0, 0.5, 0.5, 1.0})), 0.5);
  EXPECT_EQ(medianPeriod(line({1.0})), 0.0);
}

TEST(Quantile, IsLinearBetweenOrderStatistics) {
  EXPECT_DOUBLE_EQ(quantile({4.0, 1.0, 3.0, 2.0}, 0.5), 2.5);
  EXPECT_DOUBLE_EQ(quantile({4.0, 1.0, 3.0, 2.0}, 1.0), 4.0);
  EXPECT_DOUBLE_EQ(median({5.0, 1.0, 3.0}), 3.0);
  EXPECT_THROW(median({}), InvalidInput);
}

}  // namespace
}  // namespace raven_correction
