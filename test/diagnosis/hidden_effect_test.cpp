// SPDX-License-Identifier: BSD-3-Clause
// The hidden effects: an independent plant (test/plant) hides a cause in a session, the diagnosis
// has to name it, size it, and gain what the truth would gain. Fixed seeds, and fresh ones each
// run.
#include <gtest/gtest.h>

#include <cstdlib>
#include <random>

#include "diagnosis/fixtures.h"
#include "diagnosis/judge.h"
#include "plant/joint_session.h"
#include "plant/session.h"
#include "raven_correction/report/diagnosis_report.h"

namespace raven_correction {
namespace {

plant::PlantOptions session(std::uint64_t seed, bool encoders = false) {
  plant::PlantOptions options;
  options.seed = seed;
  options.encoders = encoders;
  return options;
}

/// Hides the effect and expects the verdict to name it, with its size and its gain.
void expectFound(const plant::PlantOptions& options, const plant::HiddenEffect& hidden) {
  const plant::PlantSession recorded = plant::recordHidden(options, {hidden});
  const plant::HiddenEffect& truth = recorded.truth.front();
  const Verdict verdict = diagnose(recorded.dataset, nominal(), {}, {});
  const Judgement judgement = judge(verdict, truth);
  EXPECT_TRUE(judgement.named) << plant::describe(truth) << " was not named:\n"
                               << diagnosisText(verdict);
  if (judgement.named) {
    EXPECT_TRUE(judgement.size_right) << plant::describe(truth) << " has another size:\n"
                                      << diagnosisText(verdict);
  }
  const TrueGain gain = compareGains(verdict, recorded.dataset, nominal(), recorded.truth, {});
  EXPECT_GE(gain.verdict, 0.9 * gain.truth) << diagnosisText(verdict);
}

class HiddenEffect : public testing::TestWithParam<const char*> {};

TEST_P(HiddenEffect, IsNamedSizedAndGained) {
  const plant::PlantOptions options = session(4711);
  expectFound(options, plant::drawHidden(options, GetParam(), 4711, 8.0, 20.0));
}

INSTANTIATE_TEST_SUITE_P(Catalogue, HiddenEffect,
                         testing::Values("command_delay", "tracking_lag", "drive_friction",
                                         "speed_limit", "joint_offset", "joint_gain",
                                         "joint_coupling", "backlash", "cable_stretch",
                                         "pulley_eccentricity", "creep", "link_geometry",
                                         "base_registration", "tool_offset", "registration_shift",
                                         "mocap_scale"),
                         effectName);

// Sessions nobody has seen before. The seed is printed: RAVEN_DIAGNOSIS_SEED=N repeats them.
TEST(FreshHiddenEffects, AreNamed) {
  const char* const given = std::getenv("RAVEN_DIAGNOSIS_SEED");
  const std::uint64_t seed =
      given ? std::strtoull(given, nullptr, 10) : std::random_device{}() % 1000000;
  std::printf("seed of this run: RAVEN_DIAGNOSIS_SEED=%llu\n",
              static_cast<unsigned long long>(seed));
  RecordProperty("seed", std::to_string(seed));
  static const char* const kEffects[] = {"command_delay",  "joint_gain",       "joint_coupling",
                                         "drive_friction", "tracking_lag",     "mocap_scale",
                                         "backlash",       "base_registration"};
  int missed = 0;
  for (std::uint64_t i = 0; i < 3; ++i) {
    const char* const effect = kEffects[(seed + i) % std::size(kEffects)];
    const plant::PlantOptions options = session(seed + i);
    const plant::HiddenEffect hidden = plant::drawHidden(options, effect, seed + i, 15.0, 25.0);
    const plant::PlantSession recorded = plant::recordHidden(options, {hidden});
    const Verdict verdict = diagnose(recorded.dataset, nominal(), {}, {});
    if (judge(verdict, recorded.truth.front()).named) continue;
    std::printf("RAVEN_DIAGNOSIS_SEED=%llu, %s was not named:\n%s\n",
                static_cast<unsigned long long>(seed),
                plant::describe(recorded.truth.front()).c_str(), diagnosisText(verdict).c_str());
    RecordProperty("missed_" + std::to_string(++missed), effect);
  }
  // Nineteen of twenty are promised (doc/diagnosis.md), so that one may be missed by chance.
  EXPECT_LE(missed, 1);
}

// A session in which friction and play predict the same to six digits, of which the last few speak
// for friction in every motion.
TEST(HiddenEffects, WhatPredictsTheSameIsNotToldApart) {
  const plant::PlantOptions options = session(308886);
  const plant::HiddenEffect hidden = plant::drawHidden(options, "backlash", 308886, 15.0, 25.0);
  const plant::PlantSession recorded = plant::recordHidden(options, {hidden});
  const Verdict verdict = diagnose(recorded.dataset, nominal(), {}, {});
  EXPECT_TRUE(judge(verdict, recorded.truth.front()).named) << diagnosisText(verdict);
}

TEST(HiddenEffects, TwoAtOnceAreBothNamed) {
  const plant::PlantOptions options = session(23);
  const std::vector<plant::HiddenEffect> hidden = {
      plant::drawHidden(options, "command_delay", 23, 10.0, 15.0),
      plant::drawHidden(options, "joint_gain", 24, 10.0, 15.0)};
  const plant::PlantSession recorded = plant::recordHidden(options, hidden);
  const Verdict verdict = diagnose(recorded.dataset, nominal(), {}, {});
  for (const plant::HiddenEffect& truth : recorded.truth)
    EXPECT_TRUE(judge(verdict, truth).named) << plant::describe(truth) << "\n"
                                             << diagnosisText(verdict);
}

// Friction stops the motor, play the link: only the encoders know the difference.
TEST(HiddenEffects, EncodersTellFrictionFromBacklash) {
  for (const char* const effect : {"drive_friction", "backlash"}) {
    plant::PlantOptions options = session(77, true);
    options.trajectories = 25;
    const plant::HiddenEffect hidden = plant::drawHidden(options, effect, 78, 10.0, 15.0);
    const plant::PlantSession recorded = plant::recordHidden(options, {hidden});
    DiagnosisOptions seeing;
    const Verdict with = diagnose(recorded.dataset, nominal(), {}, seeing);
    ASSERT_FALSE(with.causes.empty());
    EXPECT_EQ(with.causes.front().hypothesis.effect, effect) << diagnosisText(with);
    for (const Rival& equal : with.causes.front().equals)
      EXPECT_FALSE(equal.hypothesis.effect == "drive_friction" ||
                   equal.hypothesis.effect == "backlash")
          << diagnosisText(with);

    DiagnosisOptions blind = seeing;
    blind.recording.use_encoders = false;
    const Verdict without = diagnose(recorded.dataset, nominal(), {}, blind);
    ASSERT_FALSE(without.causes.empty());
    EXPECT_TRUE(judge(without, recorded.truth.front()).named) << diagnosisText(without);
    EXPECT_FALSE(without.causes.front().equals.empty()) << diagnosisText(without);
  }
}

TEST(CleanSessions, NothingIsClaimed) {
  for (const std::uint64_t seed : {901u, 902u, 903u}) {
    const plant::PlantSession recorded = plant::recordClean(session(seed));
    const Verdict verdict = diagnose(recorded.dataset, nominal(), {}, {});
    EXPECT_TRUE(verdict.causes.empty()) << diagnosisText(verdict);
    EXPECT_FALSE(verdict.unexplained) << diagnosisText(verdict);
    EXPECT_EQ(verdict.gain, 0.0);
  }
}

TEST(OutsideTheCatalogue, StructureIsReportedAndNobodyBlamed) {
  for (const plant::OutsideKind kind :
       {plant::OutsideKind::kVolumeDistortion, plant::OutsideKind::kTableSway}) {
    const plant::PlantSession recorded = plant::recordOutside(session(31), kind, 15.0, 31);
    const Verdict verdict = diagnose(recorded.dataset, nominal(), {}, {});
    EXPECT_TRUE(verdict.unexplained) << diagnosisText(verdict);
    EXPECT_LT(verdict.gain, 0.5) << diagnosisText(verdict);
    // Only the first depends on anything that a diagnosis could look at.
    EXPECT_EQ(verdict.depends_on.empty(), kind == plant::OutsideKind::kTableSway);
  }
}

// What the diagnosis writes is what the simulator runs: the gain is the promised one.
TEST(ExtendedSimulation, ReproducesThePromisedGain) {
  const plant::PlantOptions options = session(55);
  const plant::HiddenEffect hidden = plant::drawHidden(options, "joint_coupling", 55, 10.0, 15.0);
  const plant::PlantSession recorded = plant::recordHidden(options, {hidden});
  const Verdict verdict = diagnose(recorded.dataset, nominal(), {}, {});
  const Recording recording = makeRecording(recorded.dataset, nominal().robot, {});
  const ResidualLayout layout = residualLayout(recording);
  const double before = errorSizes(layout, residuals(recording, layout, nominal())).position_rms;
  const double after =
      errorSizes(layout, residuals(recording, layout, verdict.simulation)).position_rms;
  // Fitted to all motions it is no worse than held out.
  EXPECT_NEAR(1.0 - after / before, verdict.gain, 0.02);
  for (const Cause& cause : verdict.causes)
    for (const ParameterHandle& handle : cause.hypothesis.parameters)
      EXPECT_GT(parameterOf(verdict.simulation, handle).deviation, 0.0);
}

}  // namespace
}  // namespace raven_correction
