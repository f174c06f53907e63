// SPDX-License-Identifier: BSD-3-Clause
// What a layout keeps of its recording from one simulation to the next, against the same made anew.
#include <gtest/gtest.h>

#include "../../src/diagnosis/linear_residual.h"
#include "diagnosis/fixtures.h"
#include "raven_correction/diagnosis/held_out.h"
#include "raven_correction/diagnosis/hypothesis.h"
#include "raven_correction/error.h"
#include "raven_correction/simulation/session.h"

namespace raven_correction {
namespace {

Recording recorded() {
  RecordingOptions options;
  options.max_samples = 300;
  return makeRecording(simulateSession(nominal(), 10, 5), nominal().robot, options);
}

/// Drives, plays on either side of the motors, and what acts after them.
SimulationConfig imperfect() {
  Eigen::VectorXd values(6);
  values << 0.01, 0.02, 0.015, 0.02, 0.3, 0.01;
  return withValues(nominal(),
                    {{"drive_friction", 0},
                     {"tracking_lag", 1},
                     {"backlash", 1},
                     {"joint_gain", 0},
                     {"joint_coupling", 5},
                     {"joint_offset", 2}},
                    values);
}

// Whatever one effect becomes, what comes before it need not be simulated again.
TEST(TracedHistory, IsThatOfTheWholeSimulation) {
  const Recording recording = recorded();
  const ResidualLayout layout = residualLayout(recording);
  const RecordingSummary summary = summarise(recording);
  for (const SimulationConfig& here : {nominal(), imperfect()}) {
    const TracedHistory traced(layout.timelines->of(recording, here), here);
    int compared = 0;
    for (const Hypothesis& hypothesis : allHypotheses(recording, here)) {
      for (const Eigen::VectorXd& start : startingPoints(hypothesis, summary, here)) {
        const SimulationConfig there = withValues(here, hypothesis.parameters, start);
        const auto timeline = layout.timelines->of(recording, there);
        if (needsLoad(there) || timeline.get() != &traced.timeline()) continue;
        const JointHistory whole = jointHistory(*timeline, there), quick = traced.of(there);
        ASSERT_EQ(quick.motor, whole.motor) << hypothesisLabel(hypothesis, recording.robot);
        ASSERT_EQ(quick.joint, whole.joint) << hypothesisLabel(hypothesis, recording.robot);
        ASSERT_EQ(quick.since_start, whole.since_start);
        ++compared;
      }
    }
    EXPECT_GT(compared, 60);
  }
}

TEST(TimelineCache, RefusesARecordingThatHasChanged) {
  Recording recording = recorded();
  const ResidualLayout layout = residualLayout(recording);
  residuals(recording, layout, nominal());
  recording.motions.back().observations.pop_back();
  EXPECT_THROW(residuals(recording, layout, nominal()), InvalidInput);
}

TEST(HeldOut, SaysWhenItsSamplesWere) {
  const Recording recording = recorded();
  const ResidualLayout layout = residualLayout(recording);
  EffectFitProblem problem;
  problem.recording = &recording;
  problem.layout = &layout;
  problem.simulation = nominal();
  problem.parameters = {{"joint_offset", 0}};
  problem.start = Eigen::VectorXd::Zero(1);
  SimulatedSamples whole, held_out;
  problem.scales = channelScales(layout, residuals(recording, layout, nominal(), &whole));
  heldOutResiduals(problem, fitEffects(problem), 5, &held_out);
  EXPECT_EQ(held_out.since_start, whole.since_start);
}

}  // namespace
}  // namespace raven_correction
