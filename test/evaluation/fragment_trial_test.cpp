// SPDX-License-Identifier: BSD-3-Clause
// What counts as found, as false and as neither, on a field whose truth is written here.
#include "raven_correction/evaluation/fragment_trial.h"

#include <gtest/gtest.h>

namespace raven_correction {
namespace {

constexpr double kReach = 0.003;

/// 10 mm long, 6 mm wide, all of it visible.
VisibleFragment fragmentAt(double x, double y, double yaw = 0.0) {
  VisibleFragment fragment;
  fragment.truth.p_field = {x, y, 0.002};
  fragment.truth.yaw = yaw;
  fragment.truth.length = 0.010;
  fragment.truth.width = 0.006;
  fragment.visible_left = fragment.visible_right = 1.0;
  return fragment;
}

FragmentDetection detectionAt(double x, double y) {
  FragmentDetection detection;
  detection.p_field = {x, y, 0.002};
  detection.covariance = 1e-6 * Eigen::Matrix3d::Identity();
  return detection;
}

FragmentScore scoreOf(const std::vector<VisibleFragment>& truth,
                      const std::vector<FragmentDetection>& detections) {
  FragmentScore score;
  scoreDetections(truth, detections, kReach, score);
  return score;
}

TEST(FragmentScore, OneDetectionForOneFragment) {
  const FragmentScore score = scoreOf({fragmentAt(0.0, 0.0), fragmentAt(0.02, 0.0)},
                                      {detectionAt(0.0021, 0.0), detectionAt(0.0005, 0.0)});
  EXPECT_EQ(score.half_visible_found, 1);
  ASSERT_EQ(score.matches.size(), 1u);
  EXPECT_NEAR(score.matches[0].distance, 0.0005, 1e-12);
  EXPECT_EQ(score.false_detections, 1) << "one fragment taken for two";
  EXPECT_EQ(score.displaced, 0);
}

TEST(FragmentScore, OnAFragmentButTooFarOffIsNeitherFoundNorFalse) {
  const std::vector<VisibleFragment> truth{fragmentAt(0.0, 0.0)};
  FragmentScore score = scoreOf(truth, {detectionAt(0.004, 0.0)});
  EXPECT_EQ(score.half_visible_found, 0);
  EXPECT_EQ(score.false_detections, 0);
  EXPECT_EQ(score.displaced, 1);
  // Beside it across its short side, and beyond its end: on no fragment.
  for (const auto& [x, y] : {std::pair(0.0, 0.004), std::pair(0.006, 0.0)}) {
    score = scoreOf(truth, {detectionAt(x, y)});
    EXPECT_EQ(score.false_detections, 1) << x << " " << y;
    EXPECT_EQ(score.displaced, 0);
  }
  EXPECT_EQ(scoreOf({fragmentAt(0.0, 0.0, M_PI_2)}, {detectionAt(0.0, 0.004)}).displaced, 1);
  // Only one of them is of the fragment.
  score = scoreOf(truth, {detectionAt(0.004, 0.0), detectionAt(-0.004, 0.0)});
  EXPECT_EQ(score.displaced, 1);
  EXPECT_EQ(score.false_detections, 1);
}

}  // namespace
}  // namespace raven_correction
