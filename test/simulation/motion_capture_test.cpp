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
  config.camera_bias = 0.0;
  config.camera_loss_rate = 0.0;
  return config;
}

// Where the cameras look, and all of them see all LEDs.
const Pose kTool{{-0.02, -0.058, -0.14}, Eigen::Quaterniond(0.5, 0.5, 0.5, -0.5)};
constexpr unsigned kAll = 15;

TEST(MotionCapture, WithoutErrorsItIsExact) {
  MotionCapture mocap(quiet(), 1, 5.0);
  for (int k = 0; k < 100; ++k) {
    const double exposure = mocap.nextExposure();
    EXPECT_NEAR(exposure, 5.0 + k / 120.0, 1e-9);
    const MocapFrame frame = mocap.capture(kTool);
    ASSERT_TRUE(frame.pose);
    EXPECT_EQ(frame.pose->stamp, exposure);
    EXPECT_EQ(frame.sight, (LedSight{kAll, kAll, kAll}));
    EXPECT_LT((frame.pose->pose.p - kTool.p).norm(), 1e-15);
    EXPECT_LT(rotationAngle(frame.pose->pose.q, kTool.q), 1e-13);
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

// Cameras are covered one by one, with two, three or all four left: the pose moves when the set of
// cameras changes, and at no other instant.
TEST(MotionCapture, JumpsOnlyWhenACameraComesOrGoes) {
  MotionCaptureConfig config = quiet();
  config.camera_bias = 1e-3;
  MotionCapture mocap(config, 3);
  unsigned before = 0;
  Eigen::Vector3d last = mocap.capture(kTool).pose->pose.p;
  for (const unsigned covered : {0u, 1u, 0u, 2u, 4u, 8u, 9u, 1u, 5u, 3u, 12u, 0u}) {
    mocap.coverCameras(covered);
    for (int k = 0; k < 20; ++k) {
      const MocapFrame frame = mocap.capture(kTool);
      ASSERT_TRUE(frame.pose);
      const double step = (frame.pose->pose.p - last).norm();
      if (k == 0 && covered != before) {
        EXPECT_GT(step, 1e-5) << covered;
      } else {
        EXPECT_LT(step, 1e-12) << covered;
      }
      last = frame.pose->pose.p;
    }
    before = covered;
  }
  for (const unsigned covered : {7u, 15u}) {
    mocap.coverCameras(covered);
    EXPECT_FALSE(mocap.capture(kTool).pose) << "fewer than two cameras: missing, not wrong";
  }
}

TEST(MotionCapture, CamerasAreLostByChanceAsOftenAsSet) {
  MotionCaptureConfig config = quiet();
  config.camera_loss_rate = 1.0;
  config.camera_loss_time = 0.25;
  MotionCapture mocap(config, 3);
  int lost = 0;
  for (int k = 0; k < 40000; ++k) {
    const unsigned sight = mocap.capture(kTool).sight[0];
    for (unsigned c = 0; c < kCameras; ++c) lost += (sight >> c & 1u) != 0 ? 0 : 1;
  }
  // Sight for 1 s, blind for 0.25 s: a fifth of the time; about 1000 losses, known to 4 %.
  EXPECT_NEAR(lost / 160000.0, 0.2, 0.03);
}

TEST(CameraRig, SightFollowsTheGeometry) {
  const CameraRig rig(CameraRigConfig(), 0.0, 1);
  EXPECT_EQ(rig.sight(kTool, {}), (LedSight{kAll, kAll, kAll}));
  // A rod across the line from the gripper to camera 2 hides that camera, and no other.
  const Eigen::Vector3d middle = 0.5 * (kTool.p + rig.cameras()[2]);
  const Obstacle rod{middle - Eigen::Vector3d(0.0, 0.0, 0.2),
                     middle + Eigen::Vector3d(0.0, 0.0, 0.2), 0.03};
  EXPECT_EQ(rig.sight(kTool, {rod}), (LedSight{kAll & ~4u, kAll & ~4u, kAll & ~4u}));
  Pose turned = kTool;  // the LEDs shine away from every camera
  turned.q = turned.q * Eigen::Quaterniond(0.0, 0.0, 1.0, 0.0);
  EXPECT_EQ(rig.sight(turned, {}), (LedSight{0, 0, 0}));
  Pose away = kTool;  // out of the field of view of every camera
  away.p.z() -= 0.9;
  EXPECT_EQ(rig.sight(away, {}), (LedSight{0, 0, 0}));
  // A shaft that comes from where the cameras are stands in the line of sight of its own LEDs.
  CameraRigConfig config;
  config.remote_centre = rig.cameras()[1];
  const LedSight own = CameraRig(config, 0.0, 1).sight(kTool, {});
  EXPECT_EQ(own[0], kAll & ~2u);
}

// Another arm that reaches between a tool and a camera hides it from that camera, as far as its
// shaft goes; above its remote centre and beside it there is nothing.
TEST(CameraRig, TheInstrumentOfAnotherArmHides) {
  const CameraRig rig(CameraRigConfig(), 0.0, 1);
  CameraRigConfig other;
  other.shaft_radius = 0.02;  // no LED beside the thinner one
  const Eigen::Vector3d between = kTool.p + 0.06 * (rig.cameras()[1] - kTool.p).normalized();
  const Eigen::Vector3d up(0.0, 0.0, 0.1);
  other.remote_centre = between + up;
  const Pose through{between - up, kTool.q};
  const Obstacle instrument = instrumentOf(other, through);
  EXPECT_EQ(instrument.from, other.remote_centre);
  EXPECT_EQ(instrument.to, through.p);
  EXPECT_EQ(instrument.radius, other.shaft_radius);
  EXPECT_EQ(rig.sight(kTool, {instrument})[0], kAll & ~2u);
  const Pose drawn_back{between + 0.5 * up, kTool.q};
  EXPECT_EQ(rig.sight(kTool, {instrumentOf(other, drawn_back)})[0], kAll);
}

TEST(CameraRig, TriangulationPutsAnLedWhereTheBiasPullsIt) {
  const CameraRigConfig config;
  const CameraRig exact(config, 0.0, 1);
  EXPECT_LT((*exact.triangulate(kTool.p, 3) - kTool.p).norm(), 1e-15);
  EXPECT_FALSE(exact.triangulate(kTool.p, 4));
  const CameraRig biased(config, 1e-3, 1);
  EXPECT_LT((*biased.triangulate(config.centre, kAll) - config.centre).norm(), 1e-15)
      << "calibrated at the centre";
  EXPECT_GT((*biased.triangulate(config.centre, 7) - config.centre).norm(), 1e-4);
}

TEST(CameraRig, PoseFromLedsIsTheToolPose) {
  std::array<Eigen::Vector3d, kLeds> leds;
  for (std::size_t l = 0; l < kLeds; ++l) leds[l] = kTool * CameraRig::ledsInTool()[l];
  const Pose X = CameraRig::poseFromLeds(leds);
  EXPECT_LT((X.p - kTool.p).norm(), 1e-15);
  EXPECT_LT(rotationAngle(X.q, kTool.q), 1e-13);
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

TEST(MotionCapture, SwappedLedsGiveAWrongPose) {
  MotionCaptureConfig config = quiet();
  config.swap_rate = 1.0;
  config.swap_time = 0.1;
  MotionCapture mocap(config, 6);
  int wrong = 0;
  for (int k = 0; k < 12000; ++k) {
    const MocapFrame frame = mocap.capture(kTool);
    EXPECT_EQ(frame.swapped, rotationAngle(frame.pose->pose.q, kTool.q) > 1.0);
    if (frame.swapped) ++wrong;
  }
  // About 90 swaps in 100 s: their total is known to 15 %.
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
