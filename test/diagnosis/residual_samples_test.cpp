// SPDX-License-Identifier: BSD-3-Clause
#include "raven_correction/diagnosis/residual_samples.h"

#include <gtest/gtest.h>

#include "diagnosis/fixtures.h"
#include "raven_correction/diagnosis/dependence.h"
#include "raven_correction/diagnosis/effect_fit.h"
#include "raven_correction/diagnosis/held_out.h"
#include "raven_correction/geometry/rotation.h"
#include "raven_correction/geometry/statistics.h"
#include "raven_correction/simulation/session.h"

namespace raven_correction {
namespace {

struct Case {
  Recording recording;
  ResidualLayout layout;
  SimulatedResidual left;  // of what is believed
};
SimulationConfig with(const SimulationConfig& simulation, const std::string& effect, int index,
                      double value) {
  return withValues(simulation, {{effect, index}}, Eigen::VectorXd::Constant(1, value));
}
/// A recording of the robot as believed with one effect more.
Case caseOf(const std::string& effect, int index, double value,
            const SimulationConfig& believed = nominal()) {
  RecordingOptions options;
  options.max_samples = 800;
  Case c;
  c.recording = makeRecording(simulateSession(with(believed, effect, index, value), 10, 5),
                              nominal().robot, options);
  c.layout = residualLayout(c.recording);
  c.left.residual = residuals(c.recording, c.layout, believed, &c.left.simulated);
  return c;
}
ResidualSamples samplesOf(const Case& c, std::size_t most = 4000) {
  return residualSamples(c.recording, c.layout, c.left, {}, c.left, most);
}
DependenceResult dependenceOf(const Case& c) {
  return residualDependence(c.recording, c.layout, c.left.residual, c.left.simulated.joints,
                            c.left.simulated, 5, 1);
}
// How far the markers are turned on the tool, about its x axis [rad].
constexpr double kTurned = 0.4;
SimulationConfig withTurnedMarkers() { return with(nominal(), "tool_offset", 3, kTurned); }

double medianOf(const Eigen::MatrixXd& values, Eigen::Index row) {
  std::vector<double> list;
  for (Eigen::Index i = 0; i < values.cols(); ++i) list.push_back(values(row, i));
  return median(list);
}

// A joint that was homed wrongly errs by that much in every posture, and no other joint errs.
TEST(ResidualSamples, ProjectAnErrorOntoTheJointThatMadeIt) {
  for (const int joint : {0, 1, 2}) {
    const double size = joint == 2 ? 0.02 : 0.01;
    const Case c = caseOf("joint_offset", joint, size);
    const ResidualSamples samples = samplesOf(c);
    ASSERT_GT(samples.size(), 300u);
    for (Eigen::Index j = 0; j < 6; ++j)
      EXPECT_NEAR(medianOf(samples.before.joints, j), j == joint ? size : 0.0, 0.15 * size)
          << "joint " << j << " of " << joint;
    EXPECT_EQ(samples.aligned.tool.size(), 0);
    EXPECT_EQ(samples.load.cols(), static_cast<Eigen::Index>(samples.size()));
  }
}

// The orientation residual is in the frame of the simulated tool, markers as they are believed to
// sit: where they are turned, the nominal tool's frame is another one. A roll of the tool tells.
TEST(ResidualSamples, ProjectFromTheFrameOfTheSimulatedTool) {
  for (const int joint : {3, 4}) {
    const double size = 0.03;
    const Case c = caseOf("joint_offset", joint, size, withTurnedMarkers());
    const ResidualSamples samples = samplesOf(c);
    for (Eigen::Index j = 0; j < 6; ++j)
      EXPECT_NEAR(medianOf(samples.after.joints, j), j == joint ? size : 0.0, 0.15 * size)
          << "joint " << j << " of " << joint;
  }
}

// Each fold has a simulation of its own, and its residual is in the frame of that one's tool.
TEST(HeldOutResiduals, SayWhatTheSimulationOfTheirFoldSays) {
  const Case c = caseOf("tool_offset", 3, kTurned);
  EffectFitProblem problem;
  problem.recording = &c.recording;
  problem.layout = &c.layout;
  problem.simulation = nominal();
  problem.parameters = {{"tool_offset", 3}};
  problem.start = Eigen::VectorXd::Zero(1);
  problem.scales = channelScales(c.layout, c.left.residual);
  SimulatedSamples simulated;
  const EffectFit fit = fitEffects(problem);
  const Eigen::VectorXd residual = heldOutResiduals(problem, fit, 5, &simulated);
  for (std::size_t b = 0; b < c.layout.blocks.size(); ++b) {
    const ResidualBlock& block = c.layout.blocks[b];
    if (c.layout.channels[static_cast<std::size_t>(block.channel)].name != "orientation") continue;
    const Pose& measured = c.recording.motions[static_cast<std::size_t>(block.motion)]
                               .observations[static_cast<std::size_t>(block.sample)]
                               .pose;
    const Eigen::Vector3d expected = logRotation(simulated.tool(b).conjugate() * measured.q);
    ASSERT_LT((residual.segment<3>(block.offset) - expected).norm(), 1e-12);
    ASSERT_NEAR(rotationAngle(simulated.tool(b), c.left.simulated.tool(b)), kTurned, 0.02);
  }
}

TEST(ResidualSamples, AreThinnedEvenly) {
  const Case c = caseOf("joint_offset", 0, 0.01);
  const ResidualSamples all = samplesOf(c, 0);
  const ResidualSamples few = samplesOf(c, 100);
  EXPECT_LE(few.size(), 100u);
  EXPECT_GT(few.size(), 50u);
  EXPECT_EQ(few.motion.back(), all.motion.back());
  EXPECT_EQ(few.before.tool.cols(), static_cast<Eigen::Index>(few.size()));
}

// The samples of a recording without encoders: what they come to is what the diagnosis reports.
TEST(ResidualSamples, ComeToTheReportedErrors) {
  const Case c = caseOf("joint_offset", 1, 0.02);
  const ResidualSamples samples = samplesOf(c, 0);
  std::vector<double> lengths;
  for (Eigen::Index i = 0; i < samples.before.tool.cols(); ++i)
    lengths.push_back(samples.before.tool.col(i).head<3>().norm());
  EXPECT_NEAR(median(lengths), errorSizes(c.layout, c.left.residual).position_median, 1e-12);
}

TEST(DelayDependence, FindsADelayAndNothingElseInIt) {
  const Case late = caseOf("command_delay", 0, 0.06);
  const DependenceResult found = dependenceOf(late);
  EXPECT_GT(found.on_delay.lower, 0.6);
  EXPECT_NEAR(found.delay, 0.06, 0.015);
  const Case wrong = caseOf("joint_gain", 2, 0.05);
  const DependenceResult other = dependenceOf(wrong);
  EXPECT_LT(other.on_delay.share, 0.2);
}

// Markers that are turned on the tool turn the residual's frame, not what a delay does to it.
TEST(DelayDependence, IsInTheFrameOfTheSimulatedTool) {
  const double straight = dependenceOf(caseOf("command_delay", 0, 0.06)).on_delay.share;
  const double turned =
      dependenceOf(caseOf("command_delay", 0, 0.06, withTurnedMarkers())).on_delay.share;
  EXPECT_NEAR(turned, straight, 0.02);
}

}  // namespace
}  // namespace raven_correction
