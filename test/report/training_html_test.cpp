// SPDX-License-Identifier: BSD-3-Clause
#include "raven_correction/report/training_html.h"

#include <nlohmann/json.hpp>

#include "raven_correction/error.h"
#include "raven_correction/report/fidelity_html.h"
#include "raven_correction/report/training_report.h"
#include "raven_correction/simulation/session.h"
#include "report/page.h"
#include "report/quick_training.h"

namespace raven_correction {
namespace {

const Dataset& session() {
  static const Dataset dataset =
      simulateSession(loadSimulationConfig("config/simulation/raven2_left_case2014.yaml"), 12, 3);
  return dataset;
}

TEST(TrainingHtml, IsWellFormedAndSaysTheNumbersOfTheJson) {
  const ValidatedTraining trained = trainAndValidate(session(), quickTraining(), nullptr, 0.0);
  TrainingPage page;
  page.model_file = "<model>.bag";
  page.held_out = trained.errors;
  page.judged = trained.verdict;
  page.coverage = workspaceCoverage(session(), quickTraining(), trained.training.model.delay);
  page.streams = streamHealth(session());
  const std::string html = withPlainSpaces(trainingHtml(trained.training, page, {}));
  EXPECT_EQ(problemsOf(html), "");
  EXPECT_LT(html.size(), 1000000u);
  EXPECT_TRUE(contains(html, "&lt;model&gt;.bag"));
  EXPECT_EQ(count(html, "<em>Good:</em>"), count(html, "<figure>"));
  const auto json = nlohmann::json::parse(trainingJson(trained.training, page.model_file, &page));
  EXPECT_TRUE(contains(html, format("%.1f ms", 1e3 * json["delay_s"].get<double>())));
  EXPECT_TRUE(
      contains(html, format("%.2f mm, %.2f deg", json["rigid"]["rms_position_mm"].get<double>(),
                            json["rigid"]["rms_angle_deg"].get<double>())));
  for (const auto& [reason, number] : json["cleaning"]["rejected"].items())
    EXPECT_TRUE(
        contains(html, reason + "</td><td class=\"number\">" + std::to_string(number.get<int>())));
  // The row of norms, whole; and the same numbers in the text.
  std::vector<std::string> position, angle;
  for (const char* const column : {"none", "rigid", "full"}) {
    position.push_back(format("%.2f", json["held_out"][column]["position_norm_mm"].get<double>()));
    angle.push_back(format("%.2f", json["held_out"][column]["angle_norm_deg"].get<double>()));
    EXPECT_TRUE(contains(
        trainingText(trained.training, &page),
        format("%.2f mm, %.2f deg", json["held_out"][column]["position_norm_mm"].get<double>(),
               json["held_out"][column]["angle_norm_deg"].get<double>())));
  }
  const std::string errors = tableUnder(html, "Mean");
  EXPECT_TRUE(contains(errors, rowOf("norm [mm]", position))) << errors;
  EXPECT_TRUE(contains(errors, rowOf("norm [deg]", angle))) << errors;
  EXPECT_EQ(json["held_out"]["n"], trained.full.n);
  EXPECT_EQ(json["held_out"]["coverage95"].size(), 6u);
  EXPECT_TRUE(contains(
      html, format("%d of %d places that the robot was sent to are covered",
                   json["coverage"]["covered"].get<int>(), json["coverage"]["cells"].get<int>())));
  EXPECT_EQ(json["coverage"]["record_more"].size(), page.coverage.record_more.size());
  EXPECT_FALSE(json.contains("physics"));
  EXPECT_FALSE(contains(html, "diagnosed from"));
  EXPECT_FALSE(nlohmann::json::parse(trainingJson(trained.training, "m")).contains("held_out"));
}

// Errors of a simulation that may have seen the trajectories do not pass for errors on new ones.
TEST(TrainingHtml, SaysWhatPhysicsDoesAndWhatItMayHaveSeen) {
  TrainingConfig config = quickTraining();
  config.simulation = std::make_shared<const SimulationConfig>(
      loadSimulationConfig("config/simulation/raven2_left_case2014.yaml"));
  const ValidatedTraining trained = trainAndValidate(session(), config, nullptr, 0.0);
  TrainingPage page;
  page.held_out = trained.errors;
  page.judged = trained.verdict;
  page.coverage = workspaceCoverage(session(), config, trained.training.model.delay);
  const std::string html = withPlainSpaces(trainingHtml(trained.training, page, {}));
  EXPECT_EQ(problemsOf(html), "");
  const auto json = nlohmann::json::parse(trainingJson(trained.training, "m", &page));
  EXPECT_TRUE(contains(html, format("simulation %s leaves %.2f mm and %.2f deg",
                                    json["physics"]["simulation"].get<std::string>().c_str(),
                                    json["physics"]["rms_position_mm"].get<double>(),
                                    json["physics"]["rms_angle_deg"].get<double>())));
  EXPECT_TRUE(contains(html, format("%d more pairs are out of its reach",
                                    json["physics"]["out_of_reach"].get<int>())));
  EXPECT_TRUE(contains(html, "only if it was not diagnosed from them"));
  EXPECT_FALSE(contains(html, "trajectories it has not seen"));
  EXPECT_TRUE(contains(trainingText(trained.training, &page), "not diagnosed from them"));
  page.overlap = SimulationOverlap{true, 0, 3};  // it says what it was fitted to, and not to these
  const std::string fair = withPlainSpaces(trainingHtml(trained.training, page, {}));
  EXPECT_TRUE(contains(fair, "fitted to none of these 3"));
  EXPECT_TRUE(contains(fair, "trajectories it has not seen"));
  page.overlap->seen = 2;
  const std::string leaks = withPlainSpaces(trainingHtml(trained.training, page, {}));
  EXPECT_TRUE(contains(leaks, "fitted to 2 of these 3 trajectories"));
  EXPECT_FALSE(contains(leaks, "trajectories it has not seen"));
}

TEST(WorkspaceCoverage, CountsWhatWasLearntFromAndSaysWhereToRecordMore) {
  const TrainingConfig config = quickTraining();
  const WorkspaceCoverage all = workspaceCoverage(session(), config, 0.05);
  std::size_t commands = 0, kept = 0;
  for (const CoverageCell& cell : all.cells) {
    commands += cell.commands;
    kept += cell.kept;
  }
  EXPECT_EQ(commands, all.kept.size() + all.rejected.size());
  EXPECT_EQ(kept, all.kept.size());
  EXPECT_EQ(all.speed.size(), all.kept.size());
  EXPECT_GE(all.cells.front().commands, all.cells.back().commands);
  EXPECT_LT(all.covered, all.cells.size());
  ASSERT_FALSE(all.record_more.empty());
  // Nothing of one half of the workspace is seen: that is where to record.
  Dataset blind = session();
  const double middle = all.cells.front().centre.z();
  for (Trajectory& trajectory : blind.trajectories)
    for (StampedPose& sample : trajectory.observations)
      if (sample.pose.p.z() < middle) sample.pose.p.z() += 0.5;  // far outside: rejected
  const WorkspaceCoverage half = workspaceCoverage(blind, config, 0.05);
  EXPECT_LT(half.covered, all.covered);
  EXPECT_LT(half.record_more.front().centre.z(), middle + 0.03);
}

TEST(FidelityHtml, IsWellFormedAndSaysWhatIsNotMet) {
  FidelityResult result;
  result.trajectories = 7;
  result.hold_out = {2, 5};
  result.rows = {{"a <figure>", 1.25, std::nan(""), "mm"}};
  result.ladder = {{"none", {0.02, 0.018, 0.022}, {0.021, 0.02, 0.023}, {0.3, 0.2, 0.4}, {}}};
  result.criteria = {{"residual", -0.126, 0.15, "-"}, {"delay & co", 0.05, 0.01, "s"}};
  const std::string html = fidelityHtml(result, {}, {});
  EXPECT_EQ(problemsOf(html), "");
  EXPECT_TRUE(contains(html, "1 of 2 requirements are met on 7 trajectories"));
  EXPECT_TRUE(contains(html, "the 7 trajectories i with i % 5 == 2"));
  EXPECT_TRUE(contains(html, "where it was not fitted to these"));
  EXPECT_FALSE(contains(html, "that the simulation was not fitted to"));
  EXPECT_TRUE(contains(html, "NOT MET"));
  EXPECT_TRUE(contains(html, ">20.00</text>"));
}

}  // namespace
}  // namespace raven_correction
