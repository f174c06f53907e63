// SPDX-License-Identifier: BSD-3-Clause
// The plant's cameras make the dirt they promise, and its sessions of joints alone show what joints
// alone can show.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "plant/joint_session.h"
#include "raven_correction/error.h"

namespace raven_correction::plant {
namespace {

/// A tool at rest, seen for two minutes.
PoseStream resting() {
  PoseStream stream;
  for (int k = 0; k < 13200; ++k) stream.push_back({1000.0 + k / 110.0, Pose()});
  return stream;
}

TEST(PlantCameras, DirtIsAsOftenAsPromised) {
  const CameraOptions options;
  const PoseStream perfect = resting();
  const PoseStream seen = photograph(perfect, options, 5);
  const double n = static_cast<double>(seen.size());
  double repeated = 0.0;
  double gaps = 0.0;
  double jumped = 0.0;
  double flipped = 0.0;
  for (std::size_t k = 0; k < seen.size(); ++k) {
    jumped += seen[k].pose.p.norm() > 8.0 * options.noise;
    flipped += rotationAngle(seen[k].pose.q, Eigen::Quaterniond::Identity()) > 0.5;
    if (k == 0) continue;
    ASSERT_GE(seen[k].stamp, seen[k - 1].stamp);
    if (seen[k].stamp == seen[k - 1].stamp) {
      repeated += 1.0;
      EXPECT_EQ(seen[k].pose.p, seen[k - 1].pose.p);
      EXPECT_EQ(seen[k].pose.q.coeffs(), seen[k - 1].pose.q.coeffs());
    }
    gaps += seen[k].stamp - seen[k - 1].stamp > 0.05;
  }
  // A spell that lasts for a frame at least and is exponential in length; generous for few spells.
  EXPECT_NEAR(repeated / n, 0.09, 5.0 * std::sqrt(0.09 * 0.91 / n));
  EXPECT_GT(gaps, 10.0);
  EXPECT_LT(gaps, 60.0);
  EXPECT_GT(jumped / n, 0.005);
  EXPECT_LT(jumped / n, 0.08);
  EXPECT_GT(flipped / n, 0.0005);
  EXPECT_LT(flipped / n, 0.03);
  EXPECT_LT(n, 0.99 * static_cast<double>(perfect.size()));
}

TEST(PlantCameras, CleanOnesOnlyAddNoise) {
  const PoseStream perfect = resting();
  const PoseStream exact = photograph(perfect, cleanCameras(0.0, 0.0), 5);
  ASSERT_EQ(exact.size(), perfect.size());
  for (std::size_t k = 0; k < exact.size(); ++k) {
    EXPECT_EQ(exact[k].stamp, perfect[k].stamp);
    EXPECT_EQ(exact[k].pose.p, perfect[k].pose.p);
  }
  const PoseStream noisy = photograph(perfect, cleanCameras(1e-4, 5e-3), 5);
  EXPECT_EQ(noisy.size(), perfect.size());
  EXPECT_NE(noisy[0].pose.p, perfect[0].pose.p);
}

JointSessionOptions fewJoints(bool stops) {
  JointSessionOptions options;
  options.trajectories = 6;
  options.stops = stops;
  return options;
}

/// Observed minus held command of one joint, without noise, from `settle` after each command.
std::vector<double> residuals(const PlantSession& session, int joint, double settle) {
  std::vector<double> result;
  for (const Trajectory& trajectory : session.noise_free.trajectories) {
    const auto& commands = trajectory.joint_commands.samples;
    std::size_t c = 0;
    for (const StampedJoints& sample : trajectory.joint_observations.samples) {
      while (c + 1 < commands.size() && commands[c + 1].stamp <= sample.stamp) ++c;
      if (sample.stamp - commands[c].stamp >= settle)
        result.push_back(sample.positions(joint) - commands[c].positions(joint));
    }
  }
  return result;
}

TEST(PlantJoints, AreIdealWithoutAHiddenEffect) {
  for (const bool stops : {false, true}) {
    const PlantSession session = recordJointsClean(fewJoints(stops));
    ASSERT_EQ(session.dataset.trajectories.size(), 6u);
    const Trajectory& trajectory = session.dataset.trajectories[0];
    EXPECT_TRUE(trajectory.commands.empty());
    EXPECT_TRUE(trajectory.observations.empty());
    EXPECT_EQ(trajectory.joint_observations.names.size(), 6u);
    for (int j = 0; j < 6; ++j)
      for (const double residual : residuals(session, j, stops ? 0.0 : 3e-3))
        EXPECT_LT(std::abs(residual), 5e-5) << j;
  }
}

TEST(PlantJoints, ShowOffsetPlayAndCoupling) {
  for (const bool stops : {false, true}) {
    const double settle = stops ? 0.0 : 3e-3;
    const JointSessionOptions options = fewJoints(stops);
    const PlantSession offset =
        recordJointsHidden(options, {{"joint_offset", {4}, {{"d", 0.1}}, 0.0, 0.0}});
    for (const double residual : residuals(offset, 4, settle)) EXPECT_NEAR(residual, 0.1, 1e-4);
    EXPECT_NEAR(offset.truth[0].size_deg, 5.73, 0.01);
    const PlantSession play =
        recordJointsHidden(options, {{"backlash", {3}, {{"w", 0.04}}, 0.0, 0.0}});
    const std::vector<double> behind = residuals(play, 3, settle);
    EXPECT_NEAR(*std::max_element(behind.begin(), behind.end()), 0.02, 5e-4);
    EXPECT_NEAR(*std::min_element(behind.begin(), behind.end()), -0.02, 5e-4);
    const PlantSession coupled =
        recordJointsHidden(options, {{"joint_coupling", {5, 2}, {{"c", 2.0}}, 0.0, 0.0}});
    double largest = 0.0;
    for (const double residual : residuals(coupled, 5, settle))
      largest = std::max(largest, std::abs(residual));
    EXPECT_GT(largest, 0.05);
    EXPECT_LT(largest, 0.1001);  // q3 moves by 5 cm to either side
  }
}

TEST(PlantJoints, DrawEveryEffectTheyKnow) {
  JointSessionOptions options = fewJoints(false);
  for (const std::string& effect : jointSessionEffects()) {
    const HiddenEffect hidden = drawJointsHidden(options, effect, 3, 10.0, 10.001);
    const PlantSession session = recordJointsHidden(options, {hidden});
    const HiddenEffect& truth = session.truth.front();
    // 5e-4 rad or 5e-5 m is one multiple; a joint effect is of one joint.
    const double multiples = std::max(truth.size_mm / 0.05, truth.size_deg / 0.02865);
    EXPECT_NEAR(multiples, 10.0, 1.2) << describe(truth);
  }
  EXPECT_THROW(recordJointsHidden(options, {{"tool_offset", {}, {{"x", 0.1}}, 0.0, 0.0}}),
               InvalidInput);
}

}  // namespace
}  // namespace raven_correction::plant
