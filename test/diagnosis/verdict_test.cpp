// SPDX-License-Identifier: BSD-3-Clause
// What a verdict says of how it was asked for: driven by encoders, or with few causes allowed.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <set>

#include "diagnosis/fixtures.h"
#include "plant/joint_session.h"
#include "raven_correction/diagnosis/diagnose.h"
#include "raven_correction/report/diagnosis_report.h"
#include "raven_correction/simulation/session.h"

namespace raven_correction {
namespace {

DiagnosisOptions quick(int max_causes) {
  DiagnosisOptions options;
  options.recording.max_samples = 300;
  options.selection.max_causes = max_causes;
  options.selection.finalists = 4;
  return options;
}

/// Of the causes and of what cannot be told from them.
std::set<std::string> effectsOf(const Verdict& verdict) {
  std::set<std::string> effects;
  for (const Cause& cause : verdict.causes) {
    effects.insert(cause.hypothesis.effect);
    for (const Rival& equal : cause.equals) effects.insert(equal.hypothesis.effect);
  }
  return effects;
}

// Friction and delay are in the motors' own motion, which is given then: nothing of it is a cause.
TEST(DrivenByEncoders, OnlyWhatLiesBehindTheMotorsIsNamed) {
  constexpr double kPlay = 0.06;  // [rad]
  const SimulationConfig wrong =
      withValues(nominal(), {{"drive_friction", 0}, {"command_delay", 0}, {"backlash", 1}},
                 Eigen::Vector3d(0.08, 0.1, kPlay));
  const Dataset session = simulateSession(wrong, 15, 6);
  DiagnosisOptions options = quick(3);
  options.recording.source = DriveSource::kEncoders;
  const Verdict encoders = diagnose(session, nominal(), {}, options);

  EXPECT_EQ(encoders.source, DriveSource::kEncoders);
  EXPECT_TRUE(encoders.slow_delay.empty());
  ASSERT_FALSE(encoders.causes.empty());
  const Cause& cause = encoders.causes.front();
  EXPECT_EQ(cause.hypothesis.effect, "backlash") << diagnosisText(encoders);
  EXPECT_EQ(cause.hypothesis.joints, std::vector<int>{1}) << diagnosisText(encoders);
  EXPECT_NEAR(cause.values(0), kPlay, std::max(0.1 * kPlay, 3.0 * cause.deviations(0)));
  for (const char* const before_motors :
       {"command_delay", "tracking_lag", "drive_friction", "speed_limit", "motor_saturation"})
    EXPECT_EQ(effectsOf(encoders).count(before_motors), 0u) << before_motors << "\n"
                                                            << diagnosisText(encoders);
  // They were there to be found.
  options.recording.source = DriveSource::kCommands;
  options.recording.use_encoders = false;
  const Recording recording = makeRecording(session, nominal().robot, options.recording);
  const ResidualLayout layout = residualLayout(recording);
  const ErrorSizes sizes = errorSizes(layout, residuals(recording, layout, nominal()));
  EXPECT_GT(sizes.position_rms, 1.5 * encoders.before.sizes.position_rms);
}

TEST(MostCauses, EndTheSearchAndTheVerdictSaysSo) {
  plant::JointSessionOptions joints;
  joints.trajectories = 10;
  Dataset session = plant::recordJointsClean(joints).dataset;
  for (Trajectory& trajectory : session.trajectories)
    for (StampedJoints& sample : trajectory.joint_observations.samples)
      sample.positions.tail<2>().array() += 0.02;
  const std::string sentence = "no further cause was tried beside these ";
  for (const int most : {1, 8}) {
    const Verdict verdict =
        diagnose(session, nominal(), {false, false, true, false, false, false}, quick(most));
    const bool stopped = most == 1;
    EXPECT_EQ(verdict.causes.size(), stopped ? 1u : 2u) << diagnosisText(verdict);
    EXPECT_EQ(verdict.stopped_at_most, stopped);
    EXPECT_EQ(diagnosisText(verdict).find(sentence + "1") != std::string::npos, stopped);
    EXPECT_EQ(nlohmann::json::parse(diagnosisJson(verdict))["stopped_at_max_causes"], stopped);
  }
}

}  // namespace
}  // namespace raven_correction
