// SPDX-License-Identifier: BSD-3-Clause
// Residuals held out, which everything that is claimed rests on: one Gauss-Newton step away from
// the fit to all motions, or its derivatives alone, against fits that have not seen the fold.
#include "raven_correction/diagnosis/held_out.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "diagnosis/fixtures.h"
#include "raven_correction/simulation/session.h"

namespace raven_correction {
namespace {

constexpr int kFolds = 5;

struct Recorded {
  Recording recording;
  ResidualLayout layout;
};

Recorded recorded(const std::vector<ParameterHandle>& hidden, const Eigen::VectorXd& truth,
                  int motions) {
  RecordingOptions options;
  options.max_samples = 600;
  options.use_encoders = false;
  const SimulationConfig wrong = withValues(nominal(), hidden, truth);
  Recorded made{makeRecording(simulateSession(wrong, motions, 5), nominal().robot, options), {}};
  made.layout = residualLayout(made.recording);
  return made;
}

EffectFitProblem problemOf(const Recorded& recorded, const std::vector<ParameterHandle>& parameters,
                           const Eigen::VectorXd& start) {
  EffectFitProblem problem;
  problem.recording = &recorded.recording;
  problem.layout = &recorded.layout;
  problem.simulation = nominal();
  problem.parameters = parameters;
  problem.start = start;
  problem.scales = channelScales(
      recorded.layout,
      residuals(recorded.recording, recorded.layout, withValues(nominal(), parameters, start)));
  return problem;
}

struct Hidden {
  const char* name;
  ParameterHandle parameter;
  double truth;
};

class HeldOutStep : public testing::TestWithParam<Hidden> {};

// Everything that is claimed has to gain 0.4 % of the loss (SelectionOptions::least_share): the
// step may be wrong by a quarter of that. It is measured where it is hardest: with other causes
// left, each fold has another value (a lag of 51 to 106 ms), so the step is a long one of a
// function that is not linear. Of how far the fits are from the one to all motions it then misses 2
// % (offset), 10 % (play) and 18 % (lag), and of the loss 0.001, 0.04 and 0.05 %; with nothing else
// left a tenth of these.
TEST_P(HeldOutStep, IsWhatAFitWithoutTheFoldLeaves) {
  const ParameterHandle& parameter = GetParam().parameter;
  const Recorded data = recorded({parameter, {"joint_gain", 0}, {"joint_coupling", 3}},
                                 Eigen::Vector3d(GetParam().truth, 0.1, 0.05), 10);
  const ResidualLayout& layout = data.layout;
  const Eigen::VectorXd far = Eigen::VectorXd::Constant(1, 0.3 * GetParam().truth);
  EffectFitProblem problem = problemOf(data, {parameter}, far);
  EffectFit fit;
  for (int pass = 0; pass < 3; ++pass) {  // scales are those of what is left
    fit = fitEffects(problem);
    problem.start = fit.values;
    problem.scales = channelScales(layout, fit.residual);
  }
  const Eigen::VectorXd held_out = heldOutResiduals(problem, fit, kFolds);

  // From far away and to the end, with the fold out of sight.
  problem.start = far;
  problem.tolerance = 1e-9;
  Eigen::VectorXd real(layout.size);
  for (int fold = 0; fold < kFolds; ++fold) {
    problem.use.clear();
    for (int m = 0; m < layout.motions; ++m) problem.use.push_back(m % kFolds != fold);
    const EffectFit without = fitEffects(problem);
    ASSERT_TRUE(without.converged) << without.message;
    for (const ResidualBlock& block : layout.blocks)
      if (block.motion % kFolds == fold)
        real.segment(block.offset, layout.sizeOf(block)) =
            without.residual.segment(block.offset, layout.sizeOf(block));
  }
  const auto loss = [&](const Eigen::VectorXd& residual) {
    return motionLosses(layout, residual, problem.scales).mean();
  };
  EXPECT_GT((real - fit.residual).norm(), 5e-3 * fit.residual.norm());  // folds differ at all
  EXPECT_LT((held_out - real).norm(), 0.25 * (real - fit.residual).norm());
  EXPECT_NEAR(loss(held_out), loss(real), 1e-3 * loss(fit.residual));
  // A fold is predicted worse by others than it is fitted.
  EXPECT_GT(loss(held_out), loss(fit.residual));
}

INSTANTIATE_TEST_SUITE_P(Effects, HeldOutStep,
                         testing::Values(Hidden{"joint_offset", {"joint_offset", 1}, 0.02},
                                         Hidden{"backlash", {"backlash", 1}, 0.03},
                                         Hidden{"tracking_lag", {"tracking_lag", 1}, 0.06}),
                         [](const auto& test) { return std::string(test.param.name); });

// What is dropped has to be made up for by values that the others may have.
TEST(LinearHeldOut, StaysWithinTheRanges) {
  constexpr double kRange = 1e-3;  // the offset would go further [rad]
  Eigen::Vector2d truth(0.05, 0.02);
  const std::vector<ParameterHandle> parameters = {
      {"joint_gain", 1}, {"joint_offset", 1, 0.02 - kRange, 0.02 + kRange}};
  const Recorded data = recorded(parameters, truth, 20);
  const ResidualLayout& layout = data.layout;
  const EffectFitProblem problem = problemOf(data, parameters, truth);
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

}  // namespace
}  // namespace raven_correction
