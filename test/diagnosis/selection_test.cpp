// SPDX-License-Identifier: BSD-3-Clause
// What a selection says of the causes that it keeps, against fits made here from scratch.
#include "raven_correction/diagnosis/selection.h"

#include <gtest/gtest.h>

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
