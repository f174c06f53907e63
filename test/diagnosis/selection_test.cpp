// SPDX-License-Identifier: BSD-3-Clause
// What a selection says of the causes that it keeps, against fits made here from scratch.
#include "raven_correction/diagnosis/selection.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <set>

#include "diagnosis/fixtures.h"
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
