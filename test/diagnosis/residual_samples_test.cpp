// SPDX-License-Identifier: BSD-3-Clause
#include "raven_correction/diagnosis/residual_samples.h"

#include <gtest/gtest.h>

#include "diagnosis/fixtures.h"
#include "raven_correction/diagnosis/dependence.h"
#include "raven_correction/diagnosis/effect_fit.h"
#include "raven_correction/geometry/statistics.h"
#include "raven_correction/simulation/session.h"

namespace raven_correction {
namespace {

struct Case {
  Recording recording;
  ResidualLayout layout;
  Eigen::VectorXd residual;
  Eigen::MatrixXd joints;
};
Case caseOf(const std::string& effect, int index, double value) {
  const SimulationConfig truth =
      withValues(nominal(), {{effect, index}}, Eigen::VectorXd::Constant(1, value));
  RecordingOptions options;
  options.max_samples = 800;
  Case c;
  c.recording = makeRecording(simulateSession(truth, 10, 5), nominal().robot, options);
  c.layout = residualLayout(c.recording);
  c.residual = residuals(c.recording, c.layout, nominal(), &c.joints);
  return c;
}

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
    const ResidualSamples samples =
        residualSamples(c.recording, c.layout, c.joints, c.residual, {}, c.residual);
    ASSERT_GT(samples.size(), 300u);
    for (Eigen::Index j = 0; j < 6; ++j)
      EXPECT_NEAR(medianOf(samples.before.joints, j), j == joint ? size : 0.0, 0.15 * size)
          << "joint " << j << " of " << joint;
    EXPECT_EQ(samples.aligned.tool.size(), 0);
    EXPECT_EQ(samples.load.cols(), static_cast<Eigen::Index>(samples.size()));
  }
}

TEST(ResidualSamples, AreThinnedEvenly) {
  const Case c = caseOf("joint_offset", 0, 0.01);
  const ResidualSamples all =
      residualSamples(c.recording, c.layout, c.joints, c.residual, {}, c.residual, 0);
  const ResidualSamples few =
      residualSamples(c.recording, c.layout, c.joints, c.residual, {}, c.residual, 100);
  EXPECT_LE(few.size(), 100u);
  EXPECT_GT(few.size(), 50u);
  EXPECT_EQ(few.motion.back(), all.motion.back());
  EXPECT_EQ(few.before.tool.cols(), static_cast<Eigen::Index>(few.size()));
}

// The samples of a recording without encoders: what they come to is what the diagnosis reports.
TEST(ResidualSamples, ComeToTheReportedErrors) {
  const Case c = caseOf("joint_offset", 1, 0.02);
  const ResidualSamples samples =
      residualSamples(c.recording, c.layout, c.joints, c.residual, {}, c.residual, 0);
  std::vector<double> lengths;
  for (Eigen::Index i = 0; i < samples.before.tool.cols(); ++i)
    lengths.push_back(samples.before.tool.col(i).head<3>().norm());
  EXPECT_NEAR(median(lengths), errorSizes(c.layout, c.residual).position_median, 1e-12);
}

TEST(DelayDependence, FindsADelayAndNothingElseInIt) {
  const Case late = caseOf("command_delay", 0, 0.06);
  const DependenceResult found =
      residualDependence(late.recording, late.layout, late.residual, late.joints, 5, 1);
  EXPECT_GT(found.on_delay.lower, 0.6);
  EXPECT_NEAR(found.delay, 0.06, 0.015);
  const Case wrong = caseOf("joint_gain", 2, 0.05);
  const DependenceResult other =
      residualDependence(wrong.recording, wrong.layout, wrong.residual, wrong.joints, 5, 1);
  EXPECT_LT(other.on_delay.share, 0.2);
}

}  // namespace
}  // namespace raven_correction
