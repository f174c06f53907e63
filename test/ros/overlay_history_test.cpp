// SPDX-License-Identifier: BSD-3-Clause
// Are the errors on the screen those that the streams contain?
#include "raven_correction/ros/overlay_history.h"

#include <gtest/gtest.h>

#include <cmath>

namespace raven_correction {
namespace {

constexpr double kStart = 1000.0;

Pose along(double t) { return {{0.05 * t, 0.0, 0.0}, expRotation({0.0, 0.0, 0.5 * t})}; }

/// Seen `delay` later than wanted, `offset` beside it and turned by 0.1 rad.
StampedPose seen(double t, double delay, double offset) {
  const Pose wanted = along(t - delay);
  return {kStart + t,
          {wanted.p + Eigen::Vector3d(0.0, offset, 0.0), wanted.q * expRotation({0.1, 0.0, 0.0})}};
}

TEST(OverlayHistory, MeasuresTheErrorAgainstWhatWasWantedADelayAgo) {
  OverlayHistoryOptions options;
  options.delay = 0.16;
  OverlayHistory history(options);
  for (int k = 0; k < 200; ++k) {
    const double t = 0.01 * k;
    history.addDesired({kStart + t, along(t)});
    history.addObserved(seen(t, 0.16, 0.02));
  }
  ASSERT_TRUE(history.latest());
  EXPECT_NEAR(history.latest()->position(), 0.02, 1e-12);
  EXPECT_NEAR(history.latest()->angle(), 0.1, 1e-12);
  EXPECT_NEAR(history.mean(false).position, 0.02, 1e-12);
  EXPECT_EQ(history.mean(true).samples, 0u);
}

TEST(OverlayHistory, TellsCorrectedErrorsFromUncorrectedOnesByTheStatusOfTheirCommand) {
  OverlayHistoryOptions options;
  options.delay = 0.16;
  OverlayHistory history(options);
  for (int k = 0; k < 400; ++k) {
    const double t = 0.01 * k;
    const bool on = k >= 200;  // its effect is seen 16 samples later
    history.addStatus(kStart + t, on);
    history.addDesired({kStart + t, along(t)});
    history.addObserved(seen(t, 0.16, k >= 216 ? 0.001 : 0.02));
  }
  EXPECT_NEAR(history.mean(false).position, 0.02, 1e-9);
  EXPECT_NEAR(history.mean(true).position, 0.001, 1e-9);
  EXPECT_EQ(history.mean(true).samples, 184u);
  for (const TrackingError& error : history.errors())
    EXPECT_EQ(error.corrected, error.position() < 0.01);
  for (std::size_t i = 1; i < history.errors().size(); ++i)
    EXPECT_GE(history.errors()[i].stamp - history.errors()[i - 1].stamp, 0.2);
}

TEST(OverlayHistory, TakesTheCommandForWhatIsWantedWhereThePlannerPublishesNothingElse) {
  OverlayHistory history({});
  for (int k = 0; k < 100; ++k) {
    history.addCommand({kStart + 0.01 * k, along(0.01 * k)});
    history.addObserved(seen(0.01 * k, 0.0, 0.03));
  }
  ASSERT_TRUE(history.latest());
  EXPECT_NEAR(history.latest()->position(), 0.03, 1e-12);
}

TEST(OverlayHistory, KeepsTrailsShortSparseAndUpToDate) {
  OverlayHistoryOptions options;
  options.trail_duration = 2.0;
  OverlayHistory history(options);
  for (int k = 0; k <= 5000; ++k) history.addCommand({kStart + 0.001 * k, along(0.001 * k)});
  EXPECT_LE(history.command().size(), 102u);
  EXPECT_GE(history.command().size(), 90u);
  EXPECT_EQ(history.command().back().stamp, kStart + 5.0);
  EXPECT_GE(history.command().front().stamp, kStart + 3.0);
  history.addCommand({kStart, along(0.0)});  // a bag that loops
  EXPECT_EQ(history.command().size(), 1u);
}

TEST(OverlayHistory, IgnoresPosesThatAreNone) {
  OverlayHistory history({});
  Pose broken = along(0.0);
  broken.q.coeffs() *= 2.0;
  history.addDesired({kStart, broken});
  broken.p.x() = std::nan("");
  history.addObserved({kStart, broken});
  EXPECT_TRUE(history.desired().empty());
  EXPECT_TRUE(history.observed().empty());
}

}  // namespace
}  // namespace raven_correction
