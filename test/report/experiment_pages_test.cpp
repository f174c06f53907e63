// SPDX-License-Identifier: BSD-3-Clause
// The pages, texts and JSON of the live experiments: Table II and debridement. They run in
// test/nodes.
#include <cmath>
#include <nlohmann/json.hpp>

#include "raven_correction/report/debridement_report.h"
#include "raven_correction/report/repeatability_report.h"
#include "report/page.h"

namespace raven_correction {
namespace {

/// Off by `error` in every axis, scattering by `scatter` [m].
RepeatabilityCondition condition(const std::string& name, double error, double scatter) {
  RepeatabilityCondition made;
  made.name = name;
  made.result.visits = 100;
  made.result.errors.mean_abs.setConstant(error);
  made.result.errors.position_norm = std::sqrt(3.0) * error;
  made.result.repeatability.setConstant(scatter);
  return made;
}

RepeatabilityReport tableTwo(double left, double scatter) {
  RepeatabilityReport report;
  report.poses = report.visits = 10;
  report.conditions = {condition("none", 0.020, 0.001), condition("full", left, scatter),
                       condition("endpoint", left, scatter)};
  return report;
}

TEST(RepeatabilityPage, SaysWhetherTheAimIsReached) {
  const std::string good = withPlainSpaces(repeatabilityHtml(tableTwo(0.001, 0.0008), {}));
  EXPECT_EQ(problemsOf(good), "");
  EXPECT_TRUE(contains(good, "The correction leaves 5.0 % of the error"));
  EXPECT_TRUE(contains(good, "34.6 mm without correction, 1.73 mm with every pose corrected"));
  EXPECT_TRUE(contains(good, "20.00 \xC2\xB1 1.00 (20.3 \xC2\xB1 0.8)"));
  EXPECT_EQ(picturesOf(good).size(), 2u);
  EXPECT_EQ(count(good, "<em>Good:</em>"), count(good, "<figure>"));
  EXPECT_FALSE(contains(good, "Learn from more motions"));
  const std::string far = withPlainSpaces(repeatabilityHtml(tableTwo(0.003, 0.0012), {}));
  EXPECT_TRUE(contains(far, "Learn from more motions"));
  EXPECT_TRUE(contains(far, "scatter by at most 1.20 mm"));
  EXPECT_TRUE(contains(far, "without --no-play"));
}

DebridementCondition cleared(const std::string& name, unsigned delivered, double seconds) {
  DebridementCondition made;
  made.name = name;
  made.speed = 0.06;
  made.clearance = 0.02;
  for (std::uint64_t seed = 0; seed < 6; ++seed) {
    ClearedField field;
    field.seed = seed;
    field.fragments = 6;
    field.delivered = delivered;
    field.seconds = seconds + static_cast<double>(seed);
    FragmentRecord record;
    record.attempts = 1;
    record.picked = true;
    record.end = seconds / 6.0;
    field.records.push_back(record);
    made.fields.push_back(field);
  }
  return made;
}

DebridementReport debridement(unsigned delivered) {
  DebridementReport report;
  report.arms = 2;
  report.attempts = 4;
  report.conditions = {cleared("baseline", 5, 200.0), cleared("corrected", delivered, 50.0)};
  report.conditions[1].poses = {2000, 1970, 40};
  DebridementLearning learning;
  learning.arm = "left";
  learning.places = 120;
  learning.pairs = 4567;
  learning.trial_deviation = 0.00123;
  learning.usual_prediction = 0.0017;
  report.learning = {learning};
  return report;
}

TEST(DebridementPage, SaysTheSameInTextJsonAndPage) {
  const auto json = nlohmann::json::parse(debridementJson(debridement(6)));
  EXPECT_NEAR(json["speedup"].get<double>(), 4.6, 0.2);
  EXPECT_NEAR(json["success_difference_percent"].get<double>(), 100.0 / 6.0, 1e-9);
  EXPECT_NEAR(json["training"][0]["trial_deviation_mm"].get<double>(), 1.23, 1e-9);
  EXPECT_FALSE(json.contains("speedup_replanning"));
  EXPECT_TRUE(json["baseline"]["poses_corrected_percent"].is_null()) << "nobody was asked";
  EXPECT_NEAR(json["corrected"]["poses_corrected_percent"].get<double>(), 98.5, 1e-9);
  EXPECT_NEAR(json["corrected"]["poses_reduced_percent"].get<double>(), 2.0, 1e-9);
  const std::string text = debridementText(debridement(6));
  EXPECT_TRUE(contains(text, "success +16.7 points (+16.7 to +16.7): higher")) << text;
  EXPECT_TRUE(contains(text, "4567 pairs at 120 places")) << text;
  EXPECT_TRUE(contains(text, "98.5; 2.0")) << text;
  const std::string page = withPlainSpaces(debridementHtml(debridement(6), {}));
  EXPECT_EQ(problemsOf(page), "");
  EXPECT_TRUE(contains(page, "its success rate is no lower than the baseline"));
  EXPECT_TRUE(contains(page, "1.23"));
  EXPECT_EQ(count(page, "<em>Good:</em>"), count(page, "<figure>"));
  const std::string worse = withPlainSpaces(debridementHtml(debridement(4), {}));
  EXPECT_TRUE(contains(worse, "its success rate is LOWER than the baseline"));
  EXPECT_TRUE(contains(worse, "-16.7 points (-16.7 to -16.7), lower"));
}

// Hours of work are not lost because nothing was delivered.
TEST(DebridementPage, NothingDeliveredIsAResult) {
  const DebridementReport report = debridement(0);
  EXPECT_EQ(nlohmann::json::parse(debridementJson(report))["speedup"].get<double>(), 0.0);
  const std::string page = debridementHtml(report, {});
  EXPECT_EQ(problemsOf(page), "");
  EXPECT_TRUE(contains(page, "none delivered"));
  EXPECT_FALSE(contains(page, "nan"));
  EXPECT_FALSE(contains(debridementText(report), "nan"));
  DebridementReport none = debridement(6);
  none.conditions[0] = cleared("baseline", 0, 200.0);
  EXPECT_FALSE(nlohmann::json::parse(debridementJson(none)).contains("speedup"));
  EXPECT_FALSE(contains(debridementText(none), "times faster than the baseline"));
  EXPECT_TRUE(contains(debridementHtml(none, {}), "The baseline delivered nothing"));
}

}  // namespace
}  // namespace raven_correction
