// SPDX-License-Identifier: BSD-3-Clause
// The reports of simulated arms: how many there are in an interval, their stamps, and that they do
// not depend on how often one asks.
#include "raven_correction/ros/simulated_cell.h"

#include <gtest/gtest.h>

#include "raven_correction/error.h"
#include "raven_correction/geometry/rotation.h"

namespace raven_correction {
namespace {

constexpr double kStart = 1e6;

const SimulationConfig& simulation() {
  static const SimulationConfig config = loadSimulationConfig("config/simulation/demo.yaml");
  return config;
}

void append(const CellReport& part, CellReport& all) {
  all.measured.insert(all.measured.end(), part.measured.begin(), part.measured.end());
  all.setpoint.insert(all.setpoint.end(), part.setpoint.begin(), part.setpoint.end());
  all.joints.insert(all.joints.end(), part.joints.begin(), part.joints.end());
  all.jaw.insert(all.jaw.end(), part.jaw.begin(), part.jaw.end());
  all.mocap.insert(all.mocap.end(), part.mocap.begin(), part.mocap.end());
}

/// A small circle for `duration`, commands at 50 Hz, asked for every `tick`.
CellReport circle(double tick, double duration, std::uint64_t seed) {
  ReportRates rates;
  rates.measured_cp = 100.0;
  rates.setpoint_cp = 50.0;
  rates.measured_js = 25.0;
  SimulatedCell cell(simulation(), rates, seed, kStart);
  const Pose home = cell.arm().setpointPose();
  CellReport all;
  double next_command = kStart;
  for (double now = kStart; now <= kStart + duration; now += tick) {
    while (next_command <= now) {
      Pose pose = home;
      const double angle = 2.0 * (next_command - kStart);
      pose.p += 0.01 * Eigen::Vector3d(std::cos(angle) - 1.0, std::sin(angle), 0.0);
      cell.command({next_command, pose});
      next_command += 0.02;
    }
    append(cell.advanceTo(now), all);
  }
  append(cell.advanceTo(kStart + duration), all);
  return all;
}

TEST(SimulatedCell, ReportsAtItsRates) {
  const CellReport all = circle(1e-3, 2.0, 1);
  EXPECT_NEAR(static_cast<double>(all.measured.size()), 201.0, 1.0);
  EXPECT_NEAR(static_cast<double>(all.setpoint.size()), 101.0, 1.0);
  EXPECT_NEAR(static_cast<double>(all.joints.size()), 51.0, 1.0);
  // Frames may be missing, never more than the cameras take.
  EXPECT_LE(all.mocap.size(), 241u);
  EXPECT_GT(all.mocap.size(), 120u);
  for (std::size_t i = 1; i < all.measured.size(); ++i)
    EXPECT_NEAR(all.measured[i].stamp - all.measured[i - 1].stamp, 0.01, 1e-6);
  for (std::size_t i = 1; i < all.mocap.size(); ++i)
    EXPECT_GE(all.mocap[i].stamp, all.mocap[i - 1].stamp);
  EXPECT_EQ(all.joints.front().positions.size(), simulation().robot.size());
  EXPECT_EQ(all.jaw.size(), all.joints.size());
}

TEST(SimulatedCell, DoesNotDependOnHowOftenOneAsks) {
  const CellReport often = circle(1e-3, 1.0, 7);
  const CellReport seldom = circle(9e-3, 1.0, 7);
  ASSERT_EQ(often.measured.size(), seldom.measured.size());
  ASSERT_EQ(often.mocap.size(), seldom.mocap.size());
  for (std::size_t i = 0; i < often.mocap.size(); ++i) {
    EXPECT_EQ(often.mocap[i].stamp, seldom.mocap[i].stamp);
    // Play behind coupling depends on the step a little (doc/simulation.md); never by a micrometre.
    EXPECT_LT((often.mocap[i].pose.p - seldom.mocap[i].pose.p).norm(), 1e-6);
  }
  for (std::size_t i = 0; i < often.measured.size(); ++i)
    EXPECT_LT((often.measured[i].pose.p - seldom.measured[i].pose.p).norm(), 1e-9);
}

TEST(SimulatedCell, AnEqualSeedGivesEqualFramesAndAnotherDoesNot) {
  const CellReport one = circle(1e-3, 0.5, 3);
  const CellReport same = circle(1e-3, 0.5, 3);
  const CellReport other = circle(1e-3, 0.5, 4);
  ASSERT_EQ(one.mocap.size(), same.mocap.size());
  for (std::size_t i = 0; i < one.mocap.size(); ++i)
    EXPECT_EQ(one.mocap[i].pose.p, same.mocap[i].pose.p);
  EXPECT_NE(one.mocap.front().pose.p, other.mocap.front().pose.p);
}

TEST(SimulatedCell, LatencyDelaysTheMessageToo) {
  SimulationConfig config = simulation();
  config.motion_capture.latency = 0.05;
  SimulatedCell cell(config, {}, 1, kStart);
  for (double now = kStart; now < kStart + 1.0; now += 1e-3)
    for (const StampedPose& frame : cell.advanceTo(now).mocap) {
      EXPECT_LE(frame.stamp, now);
      EXPECT_GT(frame.stamp, now - 0.05);
    }
}

TEST(SimulatedCell, ResetGoesHomeAndRestartStaysWhereItIs) {
  SimulatedCell cell(simulation(), {}, 1, kStart);
  const Pose home = cell.arm().setpointPose();
  Pose away = home;
  away.p.x() += 0.01;
  ASSERT_TRUE(reproducesPose(cell.command({kStart, away})));
  cell.advanceTo(kStart + 1.0);
  ASSERT_LT((cell.arm().setpointPose().p - away.p).norm(), 1e-9);
  ASSERT_TRUE(cell.commandJaw(kStart + 1.0, 0.8));
  cell.advanceTo(kStart + 2.0);
  ASSERT_TRUE(cell.commandJaw(kStart + 2.0, 0.0));
  cell.advanceTo(kStart + 3.0);
  ASSERT_GT(cell.arm().payload(), 0.0);

  // On its way back, with plays and lags behind it, and a command that does not act yet.
  ASSERT_TRUE(reproducesPose(cell.command({kStart + 3.0, home})));
  cell.advanceTo(kStart + 3.0 + 0.075);
  ASSERT_TRUE(reproducesPose(cell.command({kStart + 3.1, away})));
  const Pose tool = cell.arm().toolPose();
  const Eigen::VectorXd encoders = cell.arm().encoderJoints();
  const Pose setpoint = cell.arm().setpointPose();
  ASSERT_GT((cell.arm().measuredPose().p - home.p).norm(), 1e-3) << "it must be on its way";

  cell.restart(kStart - 100.0);  // a bag that starts again
  EXPECT_LT((cell.arm().toolPose().p - tool.p).norm(), 1e-12) << "a clock does not move the arm";
  EXPECT_LT(rotationAngle(cell.arm().toolPose().q, tool.q), 1e-12);
  EXPECT_EQ(Eigen::VectorXd(cell.arm().encoderJoints()), encoders);
  EXPECT_EQ(cell.arm().setpointPose().p, setpoint.p);
  const CellReport& after = cell.advanceTo(kStart - 99.995);
  ASSERT_FALSE(after.measured.empty());
  EXPECT_EQ(after.measured.front().stamp, kStart - 100.0);

  EXPECT_GT(cell.arm().payload(), 0.0) << "it does not let go because a clock jumped";
  cell.advanceTo(kStart - 97.0);
  EXPECT_LT((cell.arm().setpointPose().p - home.p).norm(), 1e-9)
      << "the last command was forgotten";

  cell.reset(kStart - 96.0);
  EXPECT_LT((cell.arm().setpointPose().p - home.p).norm(), 1e-12);
  EXPECT_EQ(cell.arm().payload(), 0.0);
}

TEST(SimulatedCell, ReportsTheOpeningOfTheJaw) {
  SimulatedCell cell(simulation(), {}, 1, kStart);
  cell.advanceTo(kStart + 0.5);
  ASSERT_TRUE(cell.commandJaw(kStart + 0.5, 0.8));
  cell.advanceTo(kStart + 1.5);
  EXPECT_EQ(cell.report().jaw.back().positions.size(), 1);
  EXPECT_EQ(cell.report().jaw.back().positions(0), 0.8);
}

TEST(SimulatedCell, SaysWhenAndWhereTheJawPasses) {
  const double limit = simulation().gripper.grasp_opening;
  SimulatedCell cell(simulation(), {}, 1, kStart);
  const auto passagesUntil = [&](double time) { return cell.advanceTo(time).passages; };
  ASSERT_TRUE(cell.commandJaw(kStart, 0.0));
  EXPECT_TRUE(passagesUntil(kStart + 0.5).empty()) << "closed it was before";
  ASSERT_TRUE(cell.commandJaw(kStart + 0.5, 0.5 * limit));
  EXPECT_TRUE(passagesUntil(kStart + 1.0).empty()) << "not as far as that";
  ASSERT_TRUE(cell.commandJaw(kStart + 1.0, 0.8));
  const std::vector<JawPassage> opened = passagesUntil(kStart + 2.0);
  ASSERT_EQ(opened.size(), 1u);
  EXPECT_FALSE(opened[0].closed);
  EXPECT_GE(opened[0].opening, limit);
  EXPECT_LT(opened[0].opening, 0.8) << "it is still on its way";
  EXPECT_LT((opened[0].X_base_tool.p - cell.arm().toolPose().p).norm(), 1e-9);
  ASSERT_TRUE(cell.commandJaw(kStart + 2.0, 0.0));
  const std::vector<JawPassage> closed = passagesUntil(kStart + 3.0);
  ASSERT_EQ(closed.size(), 1u);
  EXPECT_TRUE(closed[0].closed);
  EXPECT_EQ(closed[0].opening, 0.8) << "the widest since it was opened";
  // From 0.8 rad at the speed of the jaw, after the delay of the controller, to the next report.
  const double travel = (0.8 - limit) / simulation().gripper.speed;
  EXPECT_GE(closed[0].stamp, kStart + 2.0 + travel);
  EXPECT_LT(closed[0].stamp, kStart + 2.0 + travel + 0.1);
  EXPECT_TRUE(passagesUntil(kStart + 4.0).empty());
}

/// The frames of a left arm whose neighbour passes between it and a camera, asked for every `tick`.
PoseStream framesBesideAnother(double tick) {
  SimulationConfig left = loadSimulationConfig("config/simulation/nominal.yaml");
  left.motion_capture.noise = 0.0;
  left.motion_capture.camera_bias = 1e-3;
  // So thick that it comes into a line of sight 67 to 87 mm away, and leaves it again.
  SimulationConfig right = loadSimulationConfig("config/simulation/raven2_right.yaml");
  right.motion_capture.rig.shaft_radius = 0.075;
  SimulatedCell first(left, {}, 1, kStart);
  SimulatedCell second(right, {}, 2, kStart);
  const Pose home = second.arm().setpointPose();
  PoseStream frames;
  double next_command = kStart;
  for (double now = kStart; now <= kStart + 2.0; now += tick) {
    while (next_command <= now) {
      Pose pose = home;
      pose.p.x() += 0.03 * std::sin(3.0 * (next_command - kStart));
      second.command({next_command, pose});
      next_command += 0.02;
    }
    advanceTogether({&first, &second}, now);
    const PoseStream& seen = first.report().mocap;
    frames.insert(frames.end(), seen.begin(), seen.end());
  }
  return frames;
}

TEST(SimulatedCell, ANeighbourHidesLedsWhereItIsAtTheExposure) {
  const PoseStream often = framesBesideAnother(1e-3);
  const PoseStream seldom = framesBesideAnother(0.02);
  int jumps = 0;
  for (std::size_t i = 0; i < std::min(often.size(), seldom.size()); ++i) {
    ASSERT_EQ(often[i].stamp, seldom[i].stamp);
    EXPECT_LT((often[i].pose.p - seldom[i].pose.p).norm(), 1e-12) << i;
    if (i > 0 && (often[i].pose.p - often[i - 1].pose.p).norm() > 1e-5) ++jumps;
  }
  EXPECT_GT(jumps, 0) << "the neighbour was in nobody's way";
}

TEST(SimulatedCell, RefusesARateItCannotKeep) {
  for (const double rate : {0.0, -1.0, 1001.0}) {
    ReportRates rates;
    rates.measured_js = rate;
    EXPECT_THROW(SimulatedCell(simulation(), rates, 1, kStart), InvalidInput) << rate;
  }
}

}  // namespace
}  // namespace raven_correction
