// SPDX-License-Identifier: BSD-3-Clause
// Commanded motions: inside the box, reachable, smooth, at rest at both ends, the same from a seed.
#include "raven_correction/simulation/debridement_motion.h"

#include <gtest/gtest.h>

#include "raven_correction/error.h"
#include "simulation/simulations.h"

namespace raven_correction {
namespace {

TEST(DebridementMotion, CommandsAreSafeAndSmooth) {
  const SimulationConfig config = shippedSimulation("nominal");
  const DebridementConfig& d = config.debridement;
  const InverseKinematics ik(config.robot);
  DebridementMotion motion(d, config.robot, 11);
  double time = 100.0;
  Pose rest = motion.rest();
  for (int i = 0; i < 60; ++i) {
    const DebridementTrajectory trajectory = motion.next(time);
    const PoseStream& commands = trajectory.commands;
    EXPECT_EQ(trajectory.kind, static_cast<DebridementTrajectory::Kind>(i % 3));
    EXPECT_EQ(trajectory.fragment, static_cast<std::uint64_t>(i / 3));
    EXPECT_EQ(commands.front().stamp, time);
    EXPECT_EQ(commands.front().pose.p, rest.p) << "it starts where the last one ended";
    EXPECT_LT((commands.back().pose.p - trajectory.target.p).norm(), 1e-15);
    EXPECT_GE(commands.back().stamp - trajectory.rest_start, d.dwell - 1e-9);
    for (std::size_t k = 0; k < commands.size(); ++k) {
      const Pose& X = commands[k].pose;
      EXPECT_TRUE((X.p.array() >= d.box_lower.array()).all());
      EXPECT_TRUE((X.p.array() <= d.box_upper.array()).all());
      EXPECT_EQ(ik.solve(X, config.robot.home()).status, IkStatus::kOk);
      if (commands[k].stamp >= trajectory.rest_start) {
        EXPECT_EQ(X.p, trajectory.target.p);
      }
      if (k == 0) continue;
      EXPECT_NEAR(commands[k].stamp - commands[k - 1].stamp, 1.0 / d.rate, 1e-9);
      // Two displacements may overlap, so twice the speed of one.
      EXPECT_LT((X.p - commands[k - 1].pose.p).norm() * d.rate, 2.0 * d.speed + 1e-9);
      EXPECT_LT(rotationAngle(X.q, commands[k - 1].pose.q) * d.rate, 2.0 * d.angular_speed + 1e-9);
    }
    rest = trajectory.target;
    time = commands.back().stamp + 0.5;
  }
}

// Open on the way to a fragment, closed when the tool rests there, open again over the receptacle.
TEST(DebridementMotion, TheJawGraspsAndLetsGoAtRest) {
  const SimulationConfig config = shippedSimulation("nominal");
  DebridementConfig d = config.debridement;
  for (const double dwell : {0.5, 0.0}) {
    d.dwell = dwell;
    DebridementMotion motion(d, config.robot, 11);
    double jaw = d.jaw_open;
    for (int i = 0; i < 9; ++i) {
      const DebridementTrajectory trajectory = motion.next(10.0);
      ASSERT_EQ(trajectory.jaw.size(), trajectory.commands.size());
      EXPECT_EQ(trajectory.jaw.front(), jaw) << "as the motion before left it";
      EXPECT_EQ(trajectory.holding, jaw == d.jaw_closed);
      for (std::size_t k = 0; k + 1 < trajectory.jaw.size(); ++k) {
        if (trajectory.commands[k].stamp < trajectory.rest_start + 0.5 * dwell - 1e-9) {
          EXPECT_EQ(trajectory.jaw[k], jaw);
        }
      }
      jaw = trajectory.jaw.back();
      const bool released = trajectory.kind == DebridementTrajectory::Kind::kMoveHolding;
      EXPECT_EQ(jaw, released ? d.jaw_open : d.jaw_closed);
    }
    EXPECT_TRUE(motion.moveTo(motion.randomTarget(), 0.0).jaw.empty());
  }
}

TEST(DebridementMotion, SpeedIsWhatWasSet) {
  const SimulationConfig config = shippedSimulation("nominal");
  DebridementConfig d = config.debridement;
  d.acceleration = 20.0;
  d.rate = 1000.0;
  DebridementMotion motion(d, config.robot, 1);
  Pose target = motion.rest();
  target.p.y() -= 0.05;
  const DebridementTrajectory trajectory = motion.moveTo(target, 0.0);
  double peak = 0.0;
  for (std::size_t k = 1; k < trajectory.commands.size(); ++k)
    peak =
        std::max(peak, (trajectory.commands[k].pose.p - trajectory.commands[k - 1].pose.p).norm());
  EXPECT_NEAR(peak * d.rate, d.speed, 1e-3 * d.speed);
}

TEST(DebridementMotion, TargetsCoverTheField) {
  const SimulationConfig config = shippedSimulation("nominal");
  const DebridementConfig& d = config.debridement;
  DebridementMotion motion(d, config.robot, 5);
  Eigen::Vector3d lowest = Eigen::Vector3d::Constant(1.0);
  Eigen::Vector3d highest = -lowest;
  double largest_turn = 0.0;
  for (int i = 0; i < 500; ++i) {
    const Pose X = motion.randomTarget();
    lowest = lowest.cwiseMin(X.p);
    highest = highest.cwiseMax(X.p);
    largest_turn = std::max(largest_turn, rotationAngle(X.q, d.orientation));
  }
  for (int i = 0; i < 3; ++i) {
    EXPECT_GE(lowest(i), d.field_centre(i) - 0.5 * d.field_size(i));
    EXPECT_LE(highest(i), d.field_centre(i) + 0.5 * d.field_size(i));
    EXPECT_GT(highest(i) - lowest(i), 0.9 * d.field_size(i));
  }
  EXPECT_GT(largest_turn, 0.15);
}

TEST(DebridementMotion, SameSeedSameMotions) {
  const SimulationConfig config = shippedSimulation("nominal");
  DebridementMotion a(config.debridement, config.robot, 21);
  DebridementMotion b(config.debridement, config.robot, 21);
  DebridementMotion other(config.debridement, config.robot, 22);
  for (int i = 0; i < 6; ++i) {
    const DebridementTrajectory first = a.next(i);
    const DebridementTrajectory second = b.next(i);
    EXPECT_EQ(first.target.p, second.target.p);
    EXPECT_EQ(first.commands.size(), second.commands.size());
    if (i == 0) {
      EXPECT_NE(first.target.p, other.next(i).target.p);
    }
  }
}

TEST(DebridementMotion, RefusesAFieldOutOfReach) {
  const SimulationConfig config = shippedSimulation("nominal");
  DebridementConfig d = config.debridement;
  d.field_centre.x() = 0.3;
  EXPECT_THROW(DebridementMotion(d, config.robot, 1), InvalidInput);
  d = config.debridement;
  d.speed = 0.0;
  EXPECT_THROW(DebridementMotion(d, config.robot, 1), InvalidInput);
  d = config.debridement;
  d.orientation = Eigen::Quaterniond::Identity();
  EXPECT_THROW(DebridementMotion(d, config.robot, 1), InvalidInput);
}

}  // namespace
}  // namespace raven_correction
