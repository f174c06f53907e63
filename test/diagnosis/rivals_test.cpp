// SPDX-License-Identifier: BSD-3-Clause
// What a verdict says of causes that it cannot tell apart: what they would be, by how much one is
// ahead, and how much the recording could tell at all; and how well it knows the instant of a
// shift.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "diagnosis/fixtures.h"
#include "raven_correction/diagnosis/diagnose.h"
#include "raven_correction/report/diagnosis_report.h"
#include "raven_correction/simulation/session.h"

namespace raven_correction {
namespace {

constexpr double kPlay = 0.08;  // [rad]

DiagnosisOptions quick(bool encoders) {
  DiagnosisOptions options;
  options.recording.max_samples = 600;
  options.recording.use_encoders = encoders;
  options.selection.max_causes = 2;
  return options;
}

/// Of friction and play of the elbow, the one that is not the cause.
const Rival* otherOf(const Cause& cause) {
  const std::string other = cause.hypothesis.effect == "backlash" ? "drive_friction" : "backlash";
  const auto found =
      std::find_if(cause.equals.begin(), cause.equals.end(), [&](const Rival& rival) {
        return rival.hypothesis.effect == other &&
               rival.hypothesis.joints == cause.hypothesis.joints;
      });
  return found == cause.equals.end() ? nullptr : &*found;
}

// Friction before the encoder and play behind it move the tool alike: without encoders a verdict
// names both, the same size, and says that no more than noise lies between them.
TEST(Rivals, FrictionAndPlayAreOneWithoutEncoders) {
  const SimulationConfig wrong =
      withValues(nominal(), {{"drive_friction", 1}}, Eigen::VectorXd::Constant(1, kPlay));
  const Dataset session = simulateSession(wrong, 20, 4);
  const Verdict blind = diagnose(session, nominal(), {}, quick(false));
  ASSERT_FALSE(blind.causes.empty());
  const Cause& cause = blind.causes.front();
  ASSERT_TRUE(cause.hypothesis.effect == "drive_friction" || cause.hypothesis.effect == "backlash")
      << diagnosisText(blind);
  const Rival* const rival = otherOf(cause);
  ASSERT_TRUE(rival) << diagnosisText(blind);
  for (const auto& [values, deviations] :
       {std::pair(cause.values, cause.deviations), std::pair(rival->values, rival->deviations)}) {
    EXPECT_NEAR(values(0), kPlay, std::max(0.1 * kPlay, 3.0 * deviations(0)));
    EXPECT_GT(deviations(0), 0.0);
  }
  EXPECT_NEAR(rival->relative_gain, 1.0, 0.1);
  EXPECT_LE(rival->z, 2.0);
  EXPECT_LT(std::abs(rival->log_likelihood), 5.0);
  EXPECT_LT(rival->log_likelihood_expected, 5.0);
  const auto json = nlohmann::json::parse(diagnosisJson(blind))["causes"][0];
  ASSERT_EQ(json["rivals"].size(), json["indistinguishable_from"].size());
  EXPECT_EQ(json["rivals"][0]["label"], json["indistinguishable_from"][0]);
  EXPECT_NE(diagnosisText(blind).find("log likelihood"), std::string::npos);

  const Verdict seeing = diagnose(session, nominal(), {}, quick(true));
  ASSERT_FALSE(seeing.causes.empty());
  EXPECT_EQ(seeing.causes.front().hypothesis.effect, "drive_friction") << diagnosisText(seeing);
  EXPECT_FALSE(otherOf(seeing.causes.front())) << diagnosisText(seeing);
}

// The instant is searched for and not fitted, and still has a deviation.
TEST(Shift, ItsInstantIsKnownAsWellAsTheSamplesAllow) {
  const ParameterHandle instant{"registration_shift", 0}, along_x{"registration_shift", 1};
  constexpr double kInstant = 40.0;  // [s]
  const SimulationConfig wrong =
      withValues(nominal(), {instant, along_x}, Eigen::Vector2d(kInstant, 0.006));
  const Dataset session = simulateSession(wrong, 30, 5);
  const Verdict verdict = diagnose(session, nominal(), {}, quick(false));
  ASSERT_FALSE(verdict.causes.empty());
  const Cause& cause = verdict.causes.front();
  ASSERT_EQ(cause.hypothesis.effect, "registration_shift") << diagnosisText(verdict);
  const Eigen::Index last = cause.values.size() - 1;  // shapes come last
  ASSERT_EQ(cause.hypothesis.parameters.back(), instant);
  EXPECT_GT(cause.deviations(last), 0.0);
  EXPECT_LT(cause.deviations(last), 5.0);
  EXPECT_NEAR(cause.values(last), kInstant, 3.0 * cause.deviations(last)) << diagnosisText(verdict);
  EXPECT_EQ(parameterOf(verdict.simulation, instant).deviation, cause.deviations(last));
}

}  // namespace
}  // namespace raven_correction
