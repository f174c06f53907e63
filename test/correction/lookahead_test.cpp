// SPDX-License-Identifier: BSD-3-Clause
// On motions that no model has seen, with a simulated arm behind the corrector: does the tool come
// nearer to where it should be at each instant when the corrector knows the path, and is it none
// the further from the path itself?
#include <gtest/gtest.h>

#include <cmath>

#include "raven_correction/correction/corrector.h"
#include "raven_correction/correction/path_follower.h"
#include "raven_correction/correction/training.h"
#include "raven_correction/simulation/session.h"

namespace raven_correction {
namespace {

constexpr double kSettled =
    0.5;  // after the start of a motion, until the correction has come in [s]

struct TrackingError {
  double position = 0.0;  ///< RMS of the tool from where it should be at each instant [m]
  double angle = 0.0;     ///< [rad]
  double path = 0.0;      ///< RMS from where it should have been the model's delay before [m]
  double share = 0.0;     ///< of poses that were corrected for the pose ahead [-]
};

/// The arm follows what the corrector makes of the motions.
TrackingError track(const Correction& model, const SimulationConfig& robot, const Dataset& motions,
                    bool knows_path) {
  CorrectorLimits limits;
  limits.max_age = limits.max_ahead = 0.0;
  limits.max_rotation = 1.5;
  Corrector corrector(limits);
  corrector.setModel(model);
  corrector.setMode(CorrectorMode::kFull);
  PathFollower path;
  TrackingError error;
  double position = 0.0, angle = 0.0, late = 0.0;
  std::size_t count = 0, poses = 0, ahead_of = 0;
  SimulatedArm arm(robot, motions.trajectories.front().commands.front().stamp - 1.0);
  for (const Trajectory& motion : motions.trajectories) {
    path.begin();
    for (const StampedPose& desired : motion.commands) path.add(desired.pose);
    const double start = motion.commands.front().stamp;
    for (const StampedPose& desired : motion.commands) {
      arm.advanceTo(desired.stamp);
      if (desired.stamp > start + kSettled) {
        const Pose tool = arm.toolPose();
        position += (tool.p - desired.pose.p).squaredNorm();
        angle += std::pow(rotationAngle(tool.q, desired.pose.q), 2);
        const auto before = poseAt(motion.commands, desired.stamp - model.delay, 1.0);
        late += (tool.p - before->p).squaredNorm();
        ++count;
      }
      path.follow(desired.stamp, desired.pose);
      const auto pose = knows_path ? path.ahead(model.delay) : std::nullopt;
      const Lookahead ahead{desired.stamp + model.delay, pose.value_or(Pose())};
      const CorrectorOutput output = corrector.correct(desired.stamp, desired.stamp, desired.pose,
                                                       false, pose ? &ahead : nullptr);
      ++poses;
      ahead_of += output.ahead;
      arm.command({desired.stamp, output.command});
    }
  }
  const auto n = static_cast<double>(count);
  error.position = std::sqrt(position / n);
  error.angle = std::sqrt(angle / n);
  error.path = std::sqrt(late / n);
  error.share = static_cast<double>(ahead_of) / static_cast<double>(poses);
  return error;
}

TEST(Lookahead, BringsTheToolWhereItShouldBeAtEachInstant) {
  const SimulationConfig robot = loadSimulationConfig("config/simulation/demo.yaml");
  const TrainingConfig config = loadTrainingConfig("test/nodes/quick_training.yaml");
  const Correction model = train(simulateSession(robot, 40, 5), config, 1.0e9).model;
  const Dataset motions = simulateSession(robot, 12, 77);  // fresh ones
  const TrackingError causal = track(model, robot, motions, false);
  const TrackingError ahead = track(model, robot, motions, true);
  RecordProperty("causal_mm", std::to_string(1e3 * causal.position));
  RecordProperty("ahead_mm", std::to_string(1e3 * ahead.position));
  RecordProperty("causal_deg", std::to_string(57.2958 * causal.angle));
  RecordProperty("ahead_deg", std::to_string(57.2958 * ahead.angle));
  RecordProperty("causal_path_mm", std::to_string(1e3 * causal.path));
  RecordProperty("share_ahead", std::to_string(ahead.share));
  EXPECT_EQ(causal.share, 0.0);
  EXPECT_GT(ahead.share, 0.8);
  EXPECT_LT(ahead.position, 0.5 * causal.position);
  EXPECT_LT(ahead.angle, causal.angle);
  // And it is no further from where it should be now than it was from where it should have been.
  EXPECT_LT(ahead.position, 1.2 * causal.path);
}

}  // namespace
}  // namespace raven_correction
