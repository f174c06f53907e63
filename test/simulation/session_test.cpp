// SPDX-License-Identifier: BSD-3-Clause
// Whole simulated recordings: complete, in order, the same from a seed, and as wrong as the robot.
#include "raven_correction/simulation/session.h"

#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <cstdio>

#include "raven_correction/error.h"
#include "raven_correction/geometry/statistics.h"
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
  double seen = 0.0;
  double expected = 0.0;
  for (const Trajectory& trajectory : session.trajectories) {
    EXPECT_GT(trajectory.commands.front().stamp, last);
    last = trajectory.commands.back().stamp;
    const double duration = last - trajectory.commands.front().stamp;
    EXPECT_NEAR(static_cast<double>(trajectory.encoders.size()), 50.0 * duration, 2.0);
    seen += static_cast<double>(trajectory.observations.size());
    expected += frames_per_second * duration;
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
  // Dropped frames, gaps, and LEDs that a dragged roll turns away from the cameras.
  EXPECT_GT(seen, 0.55 * expected);
  EXPECT_LT(seen, expected);
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

// Every joint moves alone, both ways, at every speed, and comes to rest after each stroke.
TEST(Session, ExcitationMovesEveryJointAlone) {
  const SimulationConfig config = shippedSimulation("nominal");
  const ExcitationConfig excitation;
  const Dataset session = simulateExcitation(config, excitation, 2);
  ASSERT_EQ(session.trajectories.size(), 2u * 3u * 6u);
  double last = 0.0;
  for (std::size_t i = 0; i < session.trajectories.size(); ++i) {
    const Trajectory& trajectory = session.trajectories[i];
    EXPECT_GT(trajectory.commands.front().stamp, last);
    last = trajectory.commands.back().stamp;
    if (i % 2 == 0) continue;  // an approach
    const int moving = static_cast<int>(i / 2) % 6;
    const Eigen::VectorXd base = trajectory.joint_commands.samples.front().positions;
    Eigen::VectorXd lowest = base;
    Eigen::VectorXd highest = base;
    for (const StampedJoints& sample : trajectory.joint_commands.samples) {
      lowest = lowest.cwiseMin(sample.positions);
      highest = highest.cwiseMax(sample.positions);
    }
    for (int j = 0; j < 6; ++j) {
      const double range = config.robot.upper()(j) - config.robot.lower()(j);
      if (j == moving) {
        EXPECT_GT(highest(j) - base(j), 0.02 * range) << trajectory.id;
        EXPECT_GT(base(j) - lowest(j), 0.02 * range) << trajectory.id;
      } else {
        EXPECT_LT(highest(j) - lowest(j), 1e-8) << trajectory.id << " moves joint " << j;
      }
    }
  }
}

TEST(Session, BothArmsAreIndependent) {
  const SimulationConfig left = shippedSimulation("raven2_left_case2014");
  const SimulationConfig right = shippedSimulation("raven2_right");
  const Dataset alone = simulateSession(right, 4, 8);
  const Dataset other = simulateSession(left, 4, 7);
  EXPECT_TRUE(equal(alone, simulateSession(right, 4, 8)));
  EXPECT_EQ(alone.arm, "raven2_right");
  EXPECT_FALSE(equal(alone, other));
}

/// A right arm whose cameras lose nothing by chance, and a left one beside it.
std::vector<SimulationConfig> besideEachOther() {
  std::vector<SimulationConfig> arms{shippedSimulation("raven2_right"),
                                     shippedSimulation("raven2_left_case2014")};
  MotionCaptureConfig cameras;
  cameras.rig = arms[0].motion_capture.rig;
  cameras.noise = 0.0;
  cameras.camera_bias = 1e-3;
  cameras.camera_loss_rate = 0.0;
  arms[0].motion_capture = cameras;
  return arms;
}

TEST(Session, TwoArmsHideEachOtherFromTheCameras) {
  const std::vector<SimulationConfig> arms = besideEachOther();
  const std::vector<Dataset> together = simulateSessions(arms, 12, 5);
  ASSERT_EQ(together.size(), 2u);
  const Dataset alone = simulateSession(arms[0], 12, 5);
  std::size_t hidden = 0;
  std::size_t frames = 0;
  for (std::size_t i = 0; i < alone.trajectories.size(); ++i) {
    const Trajectory& a = alone.trajectories[i];
    const Trajectory& b = together[0].trajectories[i];
    ASSERT_EQ(a.encoders.size(), b.encoders.size());
    for (std::size_t k = 0; k < a.encoders.size(); ++k)
      EXPECT_EQ(a.encoders[k].pose.p, b.encoders[k].pose.p) << "they do not touch";
    // Every frame alone is there together, unless fewer than two cameras are left.
    std::size_t k = 0;
    for (const StampedPose& seen : a.observations) {
      ++frames;
      if (k == b.observations.size() || b.observations[k].stamp != seen.stamp)
        ++hidden;
      else
        hidden += b.observations[k++].pose.p != seen.pose.p ? 1 : 0;
    }
    EXPECT_EQ(k, b.observations.size());
  }
  std::printf("%zu of %zu frames are another's view\n", hidden, frames);
  EXPECT_GT(hidden, 0u);
  EXPECT_LT(hidden, frames / 2);
}

TEST(Session, ArmsWithoutACommonFrameAreOutOfEachOthersWay) {
  std::vector<SimulationConfig> arms = besideEachOther();
  const KinematicChain robot = arms[1].robot;
  arms[1].robot = KinematicChain(robot.name(), "elsewhere", robot.baseTransform(), robot.joints(),
                                 robot.toolTransform());
  EXPECT_TRUE(equal(simulateSessions(arms, 12, 5)[0], simulateSession(arms[0], 12, 5)));
}

TEST(Session, EachArmOfTwoHasRandomNumbersOfItsOwn) {
  const SimulationConfig left = shippedSimulation("raven2_left_case2014");
  const SimulationConfig right = shippedSimulation("raven2_right");
  const std::vector<Dataset> both = simulateSessions({left, right}, 4, 7);
  EXPECT_TRUE(equal(both[0], simulateSessions({left, right}, 4, 7)[0]));
  EXPECT_TRUE(equal(both[0], simulateSession(left, 4, 7))) << "nothing is in its way";
  EXPECT_FALSE(equal(both[1], simulateSession(right, 4, 7))) << "the same as if alone";
  EXPECT_EQ(both[1].arm, "raven2_right");
}

// In a session of the task the gripper holds the payload between grasp and release, and cables that
// give way show it.
TEST(Session, ThePayloadIsFeltBetweenGraspAndRelease) {
  SimulationConfig light = simulationWith("cable_stretch", {{"s[insertion]", 0.001}});
  SimulationConfig heavy = light;
  light.gripper.payload = 0.0;
  heavy.gripper.payload = 0.1;
  const Dataset a = simulateSession(light, 6, 3);
  const Dataset b = simulateSession(heavy, 6, 3);
  for (std::size_t i = 0; i < a.trajectories.size(); ++i) {
    // The last frame but those of the dwell: half-way through the motion.
    const PoseStream& seen = a.trajectories[i].observations;
    const std::size_t middle = seen.size() / 2;
    const double sag = (seen[middle].pose.p - b.trajectories[i].observations[middle].pose.p).norm();
    if (i % 3 == 0) {
      EXPECT_LT(sag, 1e-9) << "on the way to a fragment";
    } else {
      EXPECT_GT(sag, 0.0005) << i;
    }
  }
}

TEST(Session, EncodersCountInWholeSteps) {
  SimulationConfig config = shippedSimulation("nominal");
  config.quantise_encoders = true;
  const Dataset session = simulateSession(config, 3, 6);
  double largest = 0.0;
  for (const StampedJoints& sample : session.trajectories[0].joint_observations.samples) {
    const JointVector again = config.coupling.quantised(config.robot, sample.positions, 0.0);
    EXPECT_LT((again - sample.positions).cwiseAbs().maxCoeff(), 1e-9);
  }
  SimulatedArm arm(config, 0.0);
  for (double z = 0.0; z < 0.01; z += 1e-4) {
    Pose X = config.robot.forward(config.robot.home());
    X.p.z() -= z;
    arm.command({arm.time(), X});
    arm.advanceTo(arm.time() + 0.01);
    largest = std::max(largest, (arm.measuredPose().p - X.p).norm());
  }
  EXPECT_GT(largest, 1e-7);
  EXPECT_LT(largest, 1e-4);
}

// The simulation at 1 kHz in forward kinematics per step, which does not depend on the machine: 100
// times real time are 10 us per step, and a forward kinematics takes about 0.15 us.
TEST(Session, IsFarFasterThanRealTime) {
  using Clock = std::chrono::steady_clock;
  const SimulationConfig config = shippedSimulation("raven2_left_case2014");
  SimulatedArm arm(config, 0.0);
  DebridementMotion motion(config.debridement, config.robot, 1);
  std::vector<double> simulated;
  std::vector<double> forward;
  double sink = 0.0;
  double start = 0.0;
  for (int k = 0; k < 30; ++k) {
    const PoseStream commands = motion.next(start).commands;
    for (const StampedPose& command : commands) {
      const auto t0 = Clock::now();
      arm.command(command);
      arm.advanceTo(command.stamp);  // 20 steps of 1 ms
      sink += arm.toolPose().p.x() + arm.measuredPose().p.x();
      const auto t1 = Clock::now();
      for (int i = 0; i < 20; ++i) sink += config.robot.forward(arm.joints()).p.x();
      const auto t2 = Clock::now();
      simulated.push_back(std::chrono::duration<double>(t1 - t0).count());
      forward.push_back(std::chrono::duration<double>(t2 - t1).count());
    }
    start = commands.back().stamp + 0.02;
  }
  EXPECT_TRUE(std::isfinite(sink));
  std::printf("%.0f times real time, %.1f forward kinematics per step\n", 0.02 / median(simulated),
              median(simulated) / median(forward));
  EXPECT_LT(median(simulated) / median(forward), 50.0);
}

}  // namespace
}  // namespace raven_correction
