// SPDX-License-Identifier: BSD-3-Clause
// The pages of the paper's Fig. 4 and Fig. 5.
#include <cmath>
#include <nlohmann/json.hpp>

#include "raven_correction/error.h"
#include "raven_correction/report/learning_curve_report.h"
#include "raven_correction/report/test_trace_report.h"
#include "report/page.h"

namespace raven_correction {
namespace {

/// Two motions along x; the whole model is off by 1 mm in x, the rigid step by 5.
TraceResult trace() {
  TraceResult result;
  std::vector<PoseError> none, rigid, full;
  for (std::size_t i = 0; i < 40; ++i) {
    TraceState state;
    state.trajectory = i / 20;
    state.command.p << 0.001 * static_cast<double>(i), 0.02, -0.1;
    state.observed = state.rigid = state.full = state.command;
    state.observed.p.x() += 0.02;
    state.rigid.p.x() += 0.005;
    state.full.p.x() += 0.001;
    state.sd_position.setConstant(0.002);
    result.states.push_back(state);
    none.push_back(poseError(state.observed, state.command));
    rigid.push_back(poseError(state.rigid, state.command));
    full.push_back(poseError(state.full, state.command));
  }
  result.none = summarise(none);
  result.rigid = summarise(rigid);
  result.full = summarise(full);
  result.clean_states = 60;
  result.test_trajectories = 3;
  result.n_train = 777;
  result.delay = 0.15;
  return result;
}

TEST(TestTraceReport, SaysTheSameInTextJsonAndPage) {
  const auto json = nlohmann::json::parse(testTraceJson(trace()));
  EXPECT_EQ(json["states"], 40);
  EXPECT_EQ(json["trace"]["x_mm"]["full"].size(), 40u);
  EXPECT_NEAR(json["trace"]["x_mm"]["full"][3].get<double>(), 4.0, 1e-9);
  EXPECT_NEAR(json["trace"]["z_mm"]["sd"][3].get<double>(), 2.0, 1e-9);
  EXPECT_NEAR(json["errors"]["rigid"]["mean_abs_mm"][0].get<double>(), 5.0, 1e-9);
  EXPECT_NEAR(json["errors"]["none"]["position_norm_mm"].get<double>(), 20.0, 1e-9);
  const std::string text = testTraceText(trace());
  EXPECT_TRUE(contains(text, "first 40 of 60 clean test states of 3 motions")) << text;
  EXPECT_TRUE(contains(text, "5.00")) << text;

  const std::string html = withPlainSpaces(testTraceHtml(trace(), {}));
  EXPECT_EQ(problemsOf(html), "");
  EXPECT_TRUE(contains(html, "leaves 1.00 of 20.00 mm"));
  EXPECT_EQ(picturesOf(html).size(), 6u);
  EXPECT_EQ(count(html, "<em>Good:</em>"), count(html, "<figure>"));
  EXPECT_TRUE(contains(tableUnder(html, "Mean absolute"),
                       rowOf("rigid step", {"5.00", "0.00", "0.00", "5.00", "0.00"})));
}

LearningCurveResult curve() {
  LearningCurveResult result;
  result.trajectories = 20;
  LearningCurveRow row;
  row.folds.resize(2);
  const auto add = [&](CurveMethod method, std::size_t pairs, double error) {
    row.method = method;
    row.pairs = pairs;
    row.errors.position_norm = 1e-3 * error;
    row.errors.angle_norm = 0.0174532925 * error;
    row.train_seconds = 0.01 * static_cast<double>(pairs);
    for (const int k : {0, 1}) {
      row.folds[static_cast<std::size_t>(k)] = row.errors;
      row.folds[static_cast<std::size_t>(k)].position_norm *= k == 0 ? 0.8 : 1.2;
    }
    result.rows.push_back(row);
  };
  add(CurveMethod::kNone, 0, 26.0);
  add(CurveMethod::kRigid, 0, 8.0);
  add(CurveMethod::kRegression, 100, 3.0);
  add(CurveMethod::kRegression, 460, 1.55);
  add(CurveMethod::kRegression, 1000, 1.5);
  return result;
}

TEST(LearningCurveReport, SaysTheSameInTextJsonAndPage) {
  const auto json = nlohmann::json::parse(learningCurveJson(curve()));
  EXPECT_NEAR(json["rows"][3]["train_seconds"].get<double>(), 4.6, 1e-9);
  EXPECT_TRUE(json["saved"].empty());
  EXPECT_TRUE(contains(learningCurveText(curve()), "4.60"));
  EXPECT_FALSE(contains(learningCurveText(curve()), "physics")) << "there is none";

  const std::string html = withPlainSpaces(learningCurveHtml(curve(), {}));
  EXPECT_EQ(problemsOf(html), "");
  EXPECT_EQ(picturesOf(html).size(), 3u);
  EXPECT_EQ(count(html, "<em>Good:</em>"), count(html, "<figure>"));
  EXPECT_TRUE(contains(html, "Beyond 460 pairs less than 0.1 mm and 0.1 deg is gained"));
  EXPECT_TRUE(contains(html, "1000 pairs leave 1.50 mm and 1.50 deg"));
  // A curve that still falls does not say that it is enough.
  LearningCurveResult falling = curve();
  falling.rows.pop_back();
  EXPECT_TRUE(contains(withPlainSpaces(learningCurveHtml(falling, {})),
                       "The error still falls at 460 pairs"));
}

}  // namespace
}  // namespace raven_correction
