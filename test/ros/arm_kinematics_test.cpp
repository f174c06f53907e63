// SPDX-License-Identifier: BSD-3-Clause
// Which arm joints are of: simulated sessions of one arm are held against the robot files of both.
#include "raven_correction/ros/arm_kinematics.h"

#include <gtest/gtest.h>

#include "raven_correction/error.h"
#include "raven_correction/robot/chain_file.h"
#include "raven_correction/simulation/session.h"
#include "simulation/simulations.h"

namespace raven_correction {
namespace {

constexpr char kLeft[] = "config/robots/raven2_left.yaml";
constexpr char kRight[] = "config/robots/raven2_right.yaml";

std::vector<StreamFinding> check(const Dataset& dataset, const std::vector<ArmKinematics>& arms) {
  StreamCheckOptions options;
  options.arms = arms;
  return checkDataset(dataset, options);
}

Dataset leftSession() { return simulateSession(shippedSimulation("demo"), 4, 3); }

TEST(ArmKinematics, JointsOfTheArmAgreeWithItsEncoders) {
  const auto findings = check(leftSession(), loadArms(kLeft, {kRight}, "0_link"));
  EXPECT_TRUE(findings.empty()) << toText(findings[0]);
}

TEST(ArmKinematics, JointsOfTheOtherArmAreNamed) {
  const auto findings = check(leftSession(), loadArms(kRight, {kLeft}, "0_link"));
  ASSERT_EQ(findings.size(), 1u);
  EXPECT_EQ(findings[0].what, "arm");
  EXPECT_EQ(findings[0].severity, StreamFinding::Severity::kError);
  EXPECT_NE(findings[0].remedy.find("raven2_left: the arms are mixed up"), std::string::npos);
  // Without the robot file of the other arm it is known only that it is not this one.
  const auto alone = check(leftSession(), loadArms(kRight, {}, "0_link"));
  ASSERT_EQ(alone.size(), 1u);
  EXPECT_EQ(alone[0].severity, StreamFinding::Severity::kWarning);
}

TEST(ArmKinematics, JointsInDegreesAreNamed) {
  Dataset dataset = leftSession();
  for (Trajectory& trajectory : dataset.trajectories)
    for (StampedJoints& sample : trajectory.joint_observations.samples)
      sample.positions *= 180.0 / M_PI;
  bool named = false;
  for (const StreamFinding& finding : check(dataset, loadArms(kLeft, {kRight}, "0_link")))
    named |= finding.what == "units" && finding.remedy.find("degrees") != std::string::npos;
  EXPECT_TRUE(named);
}

TEST(ArmKinematics, NamesOfOtherStacksAreKnown) {
  const KinematicChain chain = loadKinematicChain(kLeft);
  Eigen::VectorXd positions(7);
  positions << 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.8;
  JointVector expected(6);  // shoulder, elbow, tool_roll, insertion, wrist_pitch, wrist_yaw
  expected << 0.1, 0.2, 0.4, 0.3, 0.5, 0.1;
  for (const std::vector<std::string>& names :
       {std::vector<std::string>{"gold_shoulder", "gold_elbow", "gold_ins", "gold_roll",
                                 "gold_wrist", "gold_jaw1", "gold_jaw2"},
        {"shoulder_R", "elbow_R", "insertion_R", "tool_roll_R", "wrist_joint_R",
         "grasper_joint_1_R", "grasper_joint_2_R"},
        {"shoulder", "elbow", "insertion", "tool_roll", "wrist_pitch", "finger_1", "finger_2"}}) {
    const auto joints = jointsOfChain(chain, names, positions);
    ASSERT_TRUE(joints.has_value()) << names[0];
    EXPECT_LT((*joints - expected).norm(), 1e-12) << names[0];
  }
  EXPECT_FALSE(jointsOfChain(chain, {"shoulder"}, positions.head(1)).has_value());
}

TEST(ArmKinematics, ARobotOfAnotherFrameIsRefused) {
  EXPECT_THROW(loadArms(kLeft, {}, "1_link"), InvalidInput);
  EXPECT_THROW(loadArms(kLeft, {"config/robots/raven2_gold.yaml"}, "0_link"), InvalidInput);
  EXPECT_TRUE(loadArms("", {kLeft}, "0_link").empty());
}

}  // namespace
}  // namespace raven_correction
