// SPDX-License-Identifier: BSD-3-Clause
// Motion capture: noise, jumps and gaps as set, and nothing but what was set.
#include "raven_correction/simulation/motion_capture.h"

#include <gtest/gtest.h>

#include <cmath>

#include "raven_correction/error.h"

namespace raven_correction {
namespace {

MotionCaptureConfig quiet() {
  MotionCaptureConfig config;
  config.noise = 0.0;
  config.rotation_noise = 0.0;
  config.camera_bias = 0.0;
  config.camera_loss_rate = 0.0;
  return config;
}

const Pose kTool{{-0.02, -0.05, -0.15}, Eigen::Quaterniond(0.5, 0.5, 0.5, -0.5)};

TEST(MotionCapture, WithoutErrorsItIsExact) {
  MotionCapture mocap(quiet(), 1, 5.0);
  for (int k = 0; k < 100; ++k) {
    const double exposure = mocap.nextExposure();
    EXPECT_NEAR(exposure, 5.0 + k / 120.0, 1e-9);
    const MocapFrame frame = mocap.capture(kTool);
    ASSERT_TRUE(frame.pose);
    EXPECT_EQ(frame.pose->stamp, exposure);
    EXPECT_TRUE(frame.pose->pose.p == kTool.p);
    EXPECT_LT(rotationAngle(frame.pose->pose.q, kTool.q), 1e-15);
  }
}

// 3 x 20000 draws: their standard deviation is known to 0.3 %.
TEST(MotionCapture, NoiseHasTheSizeThatWasSet) {
  MotionCaptureConfig config = quiet();
  config.noise = 1e-4;
  MotionCapture mocap(config, 2);
  double sum = 0.0;
  for (int k = 0; k < 20000; ++k)
    sum += (mocap.capture(kTool).pose->pose.p - kTool.p).squaredNorm();
  EXPECT_NEAR(std::sqrt(sum / 60000.0), 1e-4, 0.02e-4);
}

TEST(MotionCapture, JumpsOnlyWhenACameraComesOrGoes) {
  MotionCaptureConfig config = quiet();
  config.camera_bias = 1e-3;
  config.camera_loss_rate = 1.0;
  config.camera_loss_time = 0.3;
  MotionCapture mocap(config, 3);
  unsigned before = 15;
  Eigen::Vector3d last = kTool.p;
  int jumps = 0;
  int missing = 0;
  for (int k = 0; k < 20000; ++k) {
    const MocapFrame frame = mocap.capture(kTool);
    if (!frame.pose) {
      ++missing;
      continue;
    }
    const bool moved = (frame.pose->pose.p - last).norm() > 1e-12;
    EXPECT_EQ(moved, frame.visible_cameras != before);
    if (moved) ++jumps;
    before = frame.visible_cameras;
    last = frame.pose->pose.p;
  }
  EXPECT_GT(jumps, 100);
  EXPECT_GT(missing, 10) << "with fewer than two cameras there is no pose";
}

TEST(MotionCapture, RepeatsDropsAndGapsAtTheirRates) {
  MotionCaptureConfig config = quiet();
  config.repeat_probability = 0.1;
  MotionCapture repeating(config, 4);
  int repeats = 0;
  double last = -1.0;
  for (int k = 0; k < 20000; ++k) {
    const MocapFrame frame = repeating.capture(kTool);
    EXPECT_EQ(frame.repeated, frame.pose->stamp == last);
    if (frame.repeated) ++repeats;
    last = frame.pose->stamp;
  }
  EXPECT_NEAR(repeats / 20000.0, 0.1, 0.01);

  config = quiet();
  config.drop_probability = 0.05;
  config.gap_rate = 0.5;
  config.gap_time = 0.2;
  MotionCapture dropping(config, 5);
  int missing = 0;
  for (int k = 0; k < 40000; ++k)
    if (!dropping.capture(kTool).pose) ++missing;
  // A gap every 2.2 s takes 9.1 %, and 5 % of the rest are dropped: 13.6 %; about 150 gaps were
  // drawn, so their total is known to 12 %.
  EXPECT_NEAR(missing / 40000.0, 0.136, 0.03);
}

TEST(MotionCapture, SwappedMarkersTurnTheFrame) {
  MotionCaptureConfig config = quiet();
  config.swap_rate = 1.0;
  config.swap_time = 0.1;
  MotionCapture mocap(config, 6);
  int wrong = 0;
  for (int k = 0; k < 12000; ++k) {
    const double angle = rotationAngle(mocap.capture(kTool).pose->pose.q, kTool.q);
    EXPECT_TRUE(angle < 1e-12 || std::abs(angle - 3.14159265358979) < 1e-12);
    if (angle > 1.0) ++wrong;
  }
  EXPECT_NEAR(wrong / 12000.0, 0.1 / 1.1, 0.05);
}

TEST(MotionCapture, StampsNeverRunBackwards) {
  MotionCaptureConfig config = quiet();
  config.stamp_jitter = 0.01;
  config.latency = 0.02;
  MotionCapture mocap(config, 7);
  double last = 0.0;
  double sum = 0.0;
  for (int k = 0; k < 5000; ++k) {
    const MocapFrame frame = mocap.capture(kTool);
    EXPECT_GE(frame.pose->stamp, last);
    last = frame.pose->stamp;
    sum += frame.pose->stamp - frame.exposure;
  }
  EXPECT_NEAR(sum / 5000.0, 0.02, 0.01);
}

TEST(MotionCapture, SameSeedSameFrames) {
  const MotionCaptureConfig config;
  MotionCapture a(config, 9);
  MotionCapture b(config, 9);
  for (int k = 0; k < 1000; ++k) {
    const MocapFrame first = a.capture(kTool);
    const MocapFrame second = b.capture(kTool);
    ASSERT_EQ(first.pose.has_value(), second.pose.has_value());
    if (first.pose) {
      EXPECT_EQ(first.pose->pose.p, second.pose->pose.p);
    }
  }
}

TEST(MotionCapture, RefusesBadNumbers) {
  MotionCaptureConfig config;
  config.rate = 0.0;
  EXPECT_THROW(MotionCapture(config, 1), InvalidInput);
  config = MotionCaptureConfig();
  config.noise = std::nan("");
  EXPECT_THROW(MotionCapture(config, 1), InvalidInput);
}

}  // namespace
}  // namespace raven_correction
