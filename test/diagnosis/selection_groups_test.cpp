// SPDX-License-Identifier: BSD-3-Clause
// What a selection tries together because it is too weak alone: groups of joints and of couplings,
// from their claim to the parameters that leave them again. Single causes are selection_test.cpp.
#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <set>

#include "plant/joint_session.h"
#include "raven_correction/diagnosis/selection.h"

namespace raven_correction {
namespace {

constexpr int kJoints = 6;

bool isPrismatic(int joint) { return joint == 2; }

/// Joints that are seen, with noise, where they were commanded to be, and what is wrong with them.
class Joints {
 public:
  explicit Joints(int motions = 20) {
    for (int j = 0; j < kJoints; ++j) prismatic_.push_back(isPrismatic(j));
    plant::JointSessionOptions options;
    options.trajectories = motions;
    dataset_ = plant::recordJointsClean(options).dataset;
    RecordingOptions all;
    all.max_samples = 0;
    home_ = makeJointRecording(dataset_, prismatic_, all).robot.home();
  }
  /// q_i += d_i + sum_j C_ij (q_j - home_j)
  void add(const Eigen::VectorXd& d, const Eigen::MatrixXd& C) {
    for (Trajectory& trajectory : dataset_.trajectories)
      for (StampedJoints& sample : trajectory.joint_observations.samples)
        sample.positions += d + C * (sample.positions - home_);
  }
  /// The joint stays at home, and is seen there with the noise of the others.
  void lock(Eigen::Index joint) {
    std::mt19937_64 engine(5);
    std::normal_distribution<double> normal(0.0, plant::JointSessionOptions().noise);
    for (Trajectory& trajectory : dataset_.trajectories) {
      for (StampedJoints& sample : trajectory.joint_commands.samples)
        sample.positions(joint) = home_(joint);
      for (StampedJoints& sample : trajectory.joint_observations.samples)
        sample.positions(joint) = home_(joint) + normal(engine);
    }
  }
  /// @param phases  if not null: what was going on
  SelectionResult select(int max_causes = 8, std::set<std::string>* phases = nullptr) const {
    RecordingOptions options;
    options.max_samples = 600;
    const Recording recording = makeJointRecording(dataset_, prismatic_, options);
    const ResidualLayout layout = residualLayout(recording);
    SimulationConfig base;
    base.robot = recording.robot;
    SelectionOptions selection;
    selection.max_causes = max_causes;
    selection.finalists = 4;
    return selectCauses(recording, layout, base, selection,
                        [&](const std::string& phase, double /*fraction*/) {
                          if (phases) phases->insert(phase);
                        });
  }

 private:
  std::vector<bool> prismatic_;
  Dataset dataset_;
  Eigen::VectorXd home_;
};

constexpr double kGain = 7e-4;        // of one joint moves it by as much as its noise [-]
constexpr double kCoupling = 7.5e-4;  // [-]

Eigen::MatrixXd gains(const std::vector<int>& joints) {
  Eigen::MatrixXd C = Eigen::MatrixXd::Zero(kJoints, kJoints);
  for (const int j : joints) C(j, j) = kGain;
  return C;
}

/// All revolute joints by one another, with either sign.
Eigen::MatrixXd couplings() {
  Eigen::MatrixXd C = Eigen::MatrixXd::Zero(kJoints, kJoints);
  for (int i = 0; i < kJoints; ++i)
    for (int j = 0; j < kJoints; ++j)
      if (i != j && !isPrismatic(i) && !isPrismatic(j)) C(i, j) = j % 2 ? kCoupling : -kCoupling;
  return C;
}

/// Its joints are exactly these, and their values are right.
void expectGains(const Cause& cause, const std::vector<int>& joints) {
  EXPECT_EQ(cause.hypothesis.effect, "joint_gain");
  EXPECT_EQ(cause.hypothesis.joints, joints);
  ASSERT_EQ(cause.values.size(), static_cast<Eigen::Index>(joints.size()));
  for (Eigen::Index i = 0; i < cause.values.size(); ++i) {
    EXPECT_NEAR(cause.values(i), kGain, 3.0 * cause.deviations(i));
    EXPECT_GT(std::abs(cause.values(i)), 2.0 * cause.deviations(i));  // less is trimmed
    EXPECT_LT(cause.deviations(i), 0.3 * kGain);
  }
}

TEST(SelectionOfGroups, GainsTooWeakAloneAreClaimedTogether) {
  for (const int joint : {0, 3}) {
    Joints one;
    one.add(Eigen::VectorXd::Zero(kJoints), gains({joint}));
    EXPECT_TRUE(one.select().causes.empty());
  }
  // The fifth joint is right, and the last one never moved: both leave the group.
  Joints four;
  four.add(Eigen::VectorXd::Zero(kJoints), gains({0, 1, 2, 3}));
  four.lock(5);
  const SelectionResult selection = four.select();
  ASSERT_EQ(selection.causes.size(), 1u);
  expectGains(selection.causes.front(), {0, 1, 2, 3});
  EXPECT_FALSE(selection.stopped_at_most);
  EXPECT_TRUE(selection.converged);
}

// Parameters that leave the group lie between those of others.
TEST(SelectionOfGroups, StandBesideSingleCauses) {
  constexpr double kOffset = 0.02;
  Joints joints;
  Eigen::VectorXd d = Eigen::VectorXd::Zero(kJoints);
  d(4) = kOffset;
  joints.add(d, gains({0, 2, 3, 5}));
  const SelectionResult selection = joints.select();
  ASSERT_EQ(selection.causes.size(), 2u);
  const Cause& offset = selection.causes[1];
  EXPECT_EQ(offset.hypothesis.effect, "joint_offset");
  EXPECT_EQ(offset.hypothesis.joints, std::vector<int>{4});
  EXPECT_NEAR(offset.values(0), kOffset, 3.0 * offset.deviations(0));
  expectGains(selection.causes[0], {0, 2, 3, 5});
  // What the simulation has is what the causes say.
  for (const Cause& cause : selection.causes)
    for (std::size_t i = 0; i < cause.hypothesis.parameters.size(); ++i)
      EXPECT_EQ(parameterOf(selection.simulation, cause.hypothesis.parameters[i]).value,
                cause.values(static_cast<Eigen::Index>(i)));
  EXPECT_EQ(parameterOf(selection.simulation, {"joint_gain", 1}).value, 0.0);
  EXPECT_EQ(parameterOf(selection.simulation, {"joint_gain", 4}).value, 0.0);
}

/// Each is of one moved joint, by the revolute ones; and the values are right.
void expectCouplings(const SelectionResult& selection) {
  std::set<int> moved;
  for (const Cause& cause : selection.causes) {
    EXPECT_EQ(cause.hypothesis.effect, "joint_coupling");
    ASSERT_GE(cause.hypothesis.joints.size(), 2u);  // the moved one, then what moves it
    const int row = cause.hypothesis.joints.front();
    EXPECT_TRUE(moved.insert(row).second) << row;
    EXPECT_FALSE(isPrismatic(row));
    EXPECT_EQ(cause.hypothesis.joints.size(), 5u);
    ASSERT_EQ(cause.values.size(), static_cast<Eigen::Index>(cause.hypothesis.joints.size()) - 1);
    for (Eigen::Index i = 0; i < cause.values.size(); ++i) {
      const int by = cause.hypothesis.joints[static_cast<std::size_t>(i) + 1];
      EXPECT_NEAR(cause.values(i), couplings()(row, by), 3.5 * cause.deviations(i))
          << row << " by " << by;
      const EffectParameter parameter = parameterOf(
          selection.simulation, cause.hypothesis.parameters[static_cast<std::size_t>(i)]);
      EXPECT_EQ(parameter.joint, row);
      EXPECT_EQ(parameter.source, by);
      EXPECT_EQ(parameter.value, cause.values(i));
    }
  }
}

TEST(SelectionOfGroups, CouplingsAreACauseForEachMovedJoint) {
  Joints joints;
  joints.add(Eigen::VectorXd::Zero(kJoints), couplings());
  std::set<std::string> phases;
  const SelectionResult selection = joints.select(8, &phases);
  EXPECT_GE(selection.causes.size(), 4u);  // of five; 20 motions are few, and one misses narrowly
  expectCouplings(selection);
  EXPECT_FALSE(selection.stopped_at_most);
  // They came as one, the sixth joint's among them.
  EXPECT_EQ(phases.count("removing what no longer earns its place: 6 of 6 causes dropped in turn"),
            1u);
}

// All couplings are six causes, more than may be: the ones into a single joint are tried instead.
TEST(SelectionOfGroups, LeaveNoMoreCausesThanMayBe) {
  Joints joints;
  joints.add(Eigen::VectorXd::Zero(kJoints), couplings());
  const SelectionResult selection = joints.select(2);
  EXPECT_EQ(selection.causes.size(), 2u);
  expectCouplings(selection);
  EXPECT_TRUE(selection.stopped_at_most);
}

TEST(SelectionOfGroups, NoCauseMayBe) {
  Joints joints;
  joints.add(Eigen::VectorXd::Constant(kJoints, 0.02), gains({}));
  std::set<std::string> phases;
  const SelectionResult selection = joints.select(0, &phases);
  EXPECT_TRUE(selection.causes.empty());
  EXPECT_TRUE(selection.stopped_at_most);
  for (const std::string& phase : phases) EXPECT_EQ(phase.find("trying"), phase.npos);
}

}  // namespace
}  // namespace raven_correction
