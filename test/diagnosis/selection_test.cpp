// SPDX-License-Identifier: BSD-3-Clause
// What a selection says of the causes that it keeps, against fits made here from scratch.
#include "raven_correction/diagnosis/selection.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <set>

#include "diagnosis/fixtures.h"
#include "plant/joint_session.h"
#include "raven_correction/diagnosis/claim.h"
#include "raven_correction/error.h"
#include "raven_correction/simulation/session.h"

namespace raven_correction {
namespace {

/// A robot with several causes that can make up for one another: an offset, a gain and a link of
/// the same joint, and a registration.
const Recording& recording() {
  static const Recording made = [] {
    Eigen::VectorXd truth(4);
    truth << 0.02, 0.05, 0.01, 0.004;
    const SimulationConfig wrong = withValues(
        nominal(),
        {{"joint_offset", 1}, {"joint_gain", 1}, {"joint_offset", 0}, {"base_registration", 2}},
        truth);
    RecordingOptions options;
    options.max_samples = 600;
    options.use_encoders = false;
    return makeRecording(simulateSession(wrong, 40, 5), nominal().robot, options);
  }();
  return made;
}

/// Held-out residual of all causes but one, fitted until nothing changes any more.
Eigen::VectorXd without(const ResidualLayout& layout, const SelectionResult& selection,
                        std::size_t dropped) {
  EffectFitProblem problem;
  problem.recording = &recording();
  problem.layout = &layout;
  problem.simulation = nominal();
  std::vector<double> start;
  for (std::size_t i = 0; i < selection.causes.size(); ++i) {
    if (i == dropped) continue;
    const Cause& cause = selection.causes[i];
    const auto& parameters = cause.hypothesis.parameters;
    problem.parameters.insert(problem.parameters.end(), parameters.begin(), parameters.end());
    start.insert(start.end(), cause.values.data(), cause.values.data() + cause.values.size());
  }
  problem.start =
      Eigen::Map<Eigen::VectorXd>(start.data(), static_cast<Eigen::Index>(start.size()));
  EffectFit fit;
  fit.residual = residuals(recording(), layout,
                           withValues(problem.simulation, problem.parameters, problem.start));
  problem.tolerance = 1e-9;
  problem.max_iterations = 60;
  for (int pass = 0; pass < 4; ++pass) {  // scales are those of what is left
    problem.scales = channelScales(layout, fit.residual);
    fit = fitEffects(problem);
    problem.start = fit.values;
  }
  return heldOutResiduals(problem, fit, SelectionOptions().folds);
}

// A useless hypothesis passes as often as the threshold says, and not four times as often.
TEST(ClaimRule, TheThresholdHasItsChance) {
  constexpr int kMotions = 12, kTrials = 6000;
  constexpr double kChance = 0.01;
  const double threshold = typicalThreshold(kChance, kMotions);
  std::mt19937_64 engine(9);
  std::normal_distribution<double> normal;
  int beyond = 0;
  for (int trial = 0; trial < kTrials; ++trial) {
    const Eigen::VectorXd before = Eigen::VectorXd::Constant(kMotions, 10.0);
    Eigen::VectorXd after = before;
    for (Eigen::Index m = 0; m < kMotions; ++m) after(m) -= normal(engine);
    beyond += compareLosses(before, after, 1).z_typical > threshold;
  }
  // Four deviations of a count of 60.
  EXPECT_NEAR(beyond, kChance * kTrials, 4.0 * std::sqrt(kChance * kTrials));
}

TEST(ClaimRule, TheThresholdBecomesTheNormalQuantile) {
  EXPECT_NEAR(typicalThreshold(0.01, 4000), 2.326, 0.02);
  EXPECT_EQ(typicalThreshold(1e-4, 40), typicalThreshold(1e-4, 40));
  EXPECT_GT(typicalThreshold(1e-4, 40), typicalThreshold(1e-3, 40));
  EXPECT_GT(typicalThreshold(1e-4, 10), typicalThreshold(1e-4, 40));
  EXPECT_GT(typicalThreshold(1e-4, 40), typicalThreshold(1e-4, 400));
  EXPECT_FALSE(std::isfinite(typicalThreshold(1e-4, 1)));
}

// The gain of every motion is drawn around the same mean, as beyond chance as one wants it.
Eigen::VectorXd improved(const ResidualLayout& layout, const Eigen::VectorXd& before, double z) {
  constexpr double kGain = 0.1;
  std::mt19937_64 engine(3);
  std::normal_distribution<double> normal;
  const double root = std::sqrt(static_cast<double>(layout.motions));
  Eigen::VectorXd kept(layout.motions);
  for (double& share : kept) share = 1.0 - kGain * (1.0 + root / z * normal(engine));
  Eigen::VectorXd after = before;
  for (const ResidualBlock& block : layout.blocks)
    after.segment(block.offset, layout.sizeOf(block)) *=
        std::sqrt(std::max(0.0, kept(block.motion)));
  return after;
}

// Ten claims at once may each be ten times as likely false, so that of all as many are false.
TEST(ClaimRule, ManyClaimsMayEachBeLessSure) {
  const ResidualLayout layout = residualLayout(recording());
  const Eigen::VectorXd before = Eigen::VectorXd::Constant(layout.size, 1e-3);
  ClaimRule rule(layout, 0.004, 1);
  EXPECT_FALSE(rule.earns(before, improved(layout, before, 20.0)));  // before setTried()
  rule.setTried(1000, 0.01);
  const auto least = [&](std::size_t claims) {  // z that is enough
    rule.setClaims(claims);
    double z = 1.5;
    while (z < 20.0 && !rule.earns(before, improved(layout, before, z))) z += 0.02;
    return z;
  };
  const double one = least(1), ten = least(10), all = least(5000);
  EXPECT_LT(ten, one - 0.3);
  EXPECT_LT(all, ten - 0.3);
  EXPECT_EQ(least(1), one);
  EXPECT_LT(one, 20.0);
}

TEST(Hypothesis, WhatIsTooWeakAloneIsTriedTogether) {
  const KinematicChain& robot = nominal().robot;
  const std::vector<Hypothesis> single = allHypotheses(recording(), nominal());
  std::set<std::string> labels;
  for (const Hypothesis& group : togetherHypotheses(single, robot)) {
    EXPECT_GT(group.parameters.size(), 1u);
    EXPECT_EQ(group.shapes, 0u);
    labels.insert(hypothesisLabel(group, robot));
  }
  const std::string all = "shoulder, elbow, tool_roll, insertion, wrist_pitch, wrist_yaw";
  EXPECT_EQ(labels.count("joint_gain of " + all), 1u) << *labels.begin();
  EXPECT_EQ(labels.count("joint_coupling of elbow by shoulder, tool_roll, insertion, wrist_pitch, "
                         "wrist_yaw"),
            1u);
  for (const std::string& label : labels) {
    EXPECT_EQ(label.find("base_registration"), label.npos);
    EXPECT_EQ(label.find("pulley"), label.npos);  // has a period of its own for each joint
    EXPECT_EQ(label.find("speed_limit"), label.npos);
  }
  // One that is in the fit already is not in a group; one alone is no group.
  std::vector<Hypothesis> two;
  for (const Hypothesis& hypothesis : single)
    if (hypothesis.effect == "joint_gain" && hypothesis.joints.front() < 2)
      two.push_back(hypothesis);
  ASSERT_EQ(two.size(), 2u);
  const std::vector<Hypothesis> group = togetherHypotheses(two, robot);
  ASSERT_EQ(group.size(), 1u);
  EXPECT_EQ(parameterNames(group.front(), robot),
            (std::vector<std::string>{"g[shoulder]", "g[elbow]"}));
  EXPECT_EQ(parameterNames(two.front(), robot), (std::vector<std::string>{"g"}));
  two.pop_back();
  EXPECT_TRUE(togetherHypotheses(two, robot).empty());
}

// What is dropped has to be made up for by values that the others may have.
TEST(LinearHeldOut, StaysWithinTheRanges) {
  constexpr double kRange = 1e-3;  // the offset would go further [rad]
  constexpr int kFolds = 5;
  const ResidualLayout layout = residualLayout(recording());
  EffectFitProblem problem;
  problem.recording = &recording();
  problem.layout = &layout;
  problem.simulation = nominal();
  problem.parameters = {{"joint_gain", 1}, {"joint_offset", 1, 0.02 - kRange, 0.02 + kRange}};
  problem.start.resize(2);
  problem.start << 0.05, 0.02;
  const auto at = withValues(nominal(), problem.parameters, problem.start);
  problem.scales = channelScales(layout, residuals(recording(), layout, at));
  const EffectFit fit = fitEffects(problem);
  const Eigen::VectorXd residual = LinearHeldOut(problem, fit, kFolds).residual({0, 1, 1});
  const Eigen::VectorXd made_up =
      residual - fit.residual + fit.jacobian.col(0) * fit.values(0);  // by the offset
  for (const ResidualBlock& block : layout.blocks) {
    const auto column = fit.jacobian.col(1).segment(block.offset, layout.sizeOf(block));
    if (!(column.norm() > 0.0)) continue;
    const double step =
        column.dot(made_up.segment(block.offset, column.size())) / column.squaredNorm();
    ASSERT_LE(std::abs(fit.values(1) + step - 0.02), 1.001 * kRange);
  }
}

// A joint that follows a fifth of the way has no gain, lag or play that explains it within the
// ranges: the value at the end of a range would be no value of anything.
TEST(Selection, ClaimsNoValueAtTheEndOfItsRange) {
  plant::JointSessionOptions session;
  Dataset dataset = plant::recordJointsClean(session).dataset;
  for (Trajectory& trajectory : dataset.trajectories)
    for (StampedJoints& sample : trajectory.joint_observations.samples) sample.positions(0) *= 0.2;
  const Recording stuck =
      makeJointRecording(dataset, {false, false, true, false, false, false}, {});
  const ResidualLayout layout = residualLayout(stuck);
  SimulationConfig base;
  base.robot = stuck.robot;
  SelectionOptions options;
  options.max_causes = 4;
  const SelectionResult selection = selectCauses(stuck, layout, base, options);
  for (const Cause& cause : selection.causes)
    for (std::size_t k = 0; k < cause.hypothesis.amplitudes(); ++k) {
      const EffectParameter parameter =
          parameterOf(selection.simulation, cause.hypothesis.parameters[k]);
      const double value = cause.values(static_cast<Eigen::Index>(k));
      EXPECT_LT(value, 0.998 * parameter.upper) << hypothesisLabel(cause.hypothesis, stuck.robot);
      if (parameter.lower < 0.0) {
        EXPECT_GT(value, 0.998 * parameter.lower);
      }
    }
  EXPECT_LE(static_cast<int>(selection.causes.size()), options.max_causes);
}

TEST(Selection, SharesAreWhatTheOthersCannotMakeUpFor) {
  const ResidualLayout layout = residualLayout(recording());
  std::set<std::string> phases;
  SelectionOptions options;
  options.max_causes = 6;
  const SelectionResult selection =
      selectCauses(recording(), layout, nominal(), options,
                   [&](const std::string& phase, double) { phases.insert(phase); });
  ASSERT_GE(selection.causes.size(), 3u);
  const ClaimRule rule(layout, options.least_share, options.seed);
  for (std::size_t i = 0; i < selection.causes.size(); ++i) {
    const Cause& cause = selection.causes[i];
    const LossComparison expected =
        rule.compare(without(layout, selection, i), selection.held_out_residual);
    // The others are fitted for a limited time, which shows in the largest shares.
    EXPECT_NEAR(cause.share, expected.share, 0.05)
        << hypothesisLabel(cause.hypothesis, nominal().robot);
    EXPECT_GE(cause.share, options.least_share);
  }
  // Every pass over the causes says so: there it can be stopped.
  std::size_t passes = 0;
  for (const std::string& phase : phases) passes += phase.find("dropped in turn") != phase.npos;
  EXPECT_GE(passes, 1u);
}

}  // namespace
}  // namespace raven_correction
