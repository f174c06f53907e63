// SPDX-License-Identifier: BSD-3-Clause
// Whole simulated recordings: complete, in order, the same from a seed, and as wrong as the robot.
#include "raven_correction/simulation/session.h"

#include <gtest/gtest.h>

#include "raven_correction/error.h"
#include "simulation/simulations.h"

namespace raven_correction {
namespace {

bool equal(const Dataset& a, const Dataset& b) {
  if (a.trajectories.size() != b.trajectories.size()) return false;
  for (std::size_t i = 0; i < a.trajectories.size(); ++i) {
    const PoseStream& x = a.trajectories[i].observations;
    const PoseStream& y = b.trajectories[i].observations;
    if (x.size() != y.size()) return false;
    for (std::size_t k = 0; k < x.size(); ++k)
      if (x[k].stamp != y[k].stamp || x[k].pose.p != y[k].pose.p ||
          x[k].pose.q.coeffs() != y[k].pose.q.coeffs())
        return false;
  }
  return true;
}

TEST(Session, HoldsCompleteTrajectoriesInOrder) {
  const SimulationConfig config = shippedSimulation("raven2_left_case2014");
  const double frames_per_second = config.motion_capture.rate;
  const Dataset session = simulateSession(config, 12, 3);
  ASSERT_EQ(session.trajectories.size(), 12u);
  double last = 0.0;
  for (const Trajectory& trajectory : session.trajectories) {
    EXPECT_GT(trajectory.commands.front().stamp, last);
    last = trajectory.commands.back().stamp;
    const double duration = last - trajectory.commands.front().stamp;
    EXPECT_NEAR(static_cast<double>(trajectory.encoders.size()), 50.0 * duration, 2.0);
    EXPECT_GT(static_cast<double>(trajectory.observations.size()),
              0.5 * frames_per_second * duration);
    EXPECT_EQ(trajectory.encoders.size(), trajectory.joint_observations.samples.size());
    EXPECT_EQ(trajectory.commands.size(), trajectory.joint_commands.samples.size());
    EXPECT_EQ(trajectory.joint_commands.names.size(), 6u);
    for (const PoseStream* stream : {&trajectory.observations, &trajectory.encoders}) {
      EXPECT_GE(stream->front().stamp, trajectory.commands.front().stamp);
      EXPECT_LE(stream->back().stamp, last);
      for (std::size_t k = 1; k < stream->size(); ++k)
        EXPECT_GE((*stream)[k].stamp, (*stream)[k - 1].stamp);
    }
  }
}

TEST(Session, SameSeedSameSession) {
  const SimulationConfig config = shippedSimulation("raven2_left_case2014");
  EXPECT_TRUE(equal(simulateSession(config, 5, 1), simulateSession(config, 5, 1)));
  EXPECT_FALSE(equal(simulateSession(config, 5, 1), simulateSession(config, 5, 2)));
  EXPECT_THROW(simulateSession(config, 0, 1), InvalidInput);
}

TEST(Session, NominalRobotIsSeenWhereItWasTold) {
  const Dataset session = simulateSession(shippedSimulation("nominal"), 6, 4);
  for (const Trajectory& trajectory : session.trajectories) {
    for (const StampedPose& seen : trajectory.observations) {
      const auto told = poseAt(trajectory.commands, seen.stamp, 0.1);
      if (!told) continue;
      // A held set-point is up to 20 ms old: 1.6 mm at 80 mm/s, twice that where moves overlap.
      EXPECT_LT((told->p - seen.pose.p).norm(), 0.0032 + 6.0 * 1e-4);
    }
  }
}

TEST(Session, ReplayOfCommandsKeepsTheirStamps) {
  const SimulationConfig config = shippedSimulation("raven2_left_case2014");
  Dataset session = simulateSession(config, 6, 5);
  session.trajectories[2].commands.front().pose = Pose();  // an identity command, as measured
  const Dataset again = simulateCommands(config, session, 5);
  ASSERT_EQ(again.trajectories.size(), session.trajectories.size());
  for (std::size_t i = 0; i < again.trajectories.size(); ++i) {
    EXPECT_EQ(again.trajectories[i].id, session.trajectories[i].id);
    EXPECT_EQ(again.trajectories[i].commands.size(), session.trajectories[i].commands.size());
    const Pose& a = again.trajectories[i].encoders.back().pose;
    const Pose& b = session.trajectories[i].encoders.back().pose;
    // The same rest, but plays may have started elsewhere.
    EXPECT_LT((a.p - b.p).norm(), 0.01);
  }
  EXPECT_THROW(simulateCommands(config, Dataset(), 1), InvalidInput);
}

TEST(Session, ReplayGivesPosesAtInstants) {
  const SimulationConfig config = shippedSimulation("nominal");
  DebridementMotion motion(config.debridement, config.robot, 3);
  const DebridementTrajectory trajectory = motion.next(10.0);
  SimulatedArm arm(config);
  const std::vector<ReplaySample> samples =
      replay(arm, trajectory.commands, {10.0, trajectory.rest_start + 0.1});
  ASSERT_EQ(samples.size(), 2u);
  EXPECT_LT((samples[0].tool.p - trajectory.commands.front().pose.p).norm(), 1e-9);
  EXPECT_LT((samples[1].tool.p - trajectory.target.p).norm(), 1e-9);
}

}  // namespace
}  // namespace raven_correction
