// SPDX-License-Identifier: BSD-3-Clause
// A simulation compared with sessions of which it is known how like it they are: its own, and one
// of a robot that errs in another way.
#include "raven_correction/evaluation/fidelity.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "raven_correction/error.h"
#include "raven_correction/report/fidelity_report.h"
#include "raven_correction/simulation/effect_registry.h"
#include "raven_correction/simulation/session.h"

namespace raven_correction {
namespace {

FidelityProblem quickProblem() {
  FidelityProblem problem;
  problem.simulation = loadSimulationConfig("config/simulation/raven2_left_case2014.yaml");
  problem.training = loadTrainingConfig("config/trainer.yaml");
  problem.training.process.max_hyper_points = 100;
  problem.training.process.max_exact_points = 300;
  problem.training.process.exact_variance_points = 100;
  problem.resamples = 200;
  return problem;
}

const StatisticsRow& rowOf(const FidelityResult& result, const std::string& quantity) {
  for (const StatisticsRow& row : result.rows)
    if (row.quantity == quantity) return row;
  throw InvalidInput("no row " + quantity);
}

// The measured session is one of the same simulation with other random numbers: all requirements
// are met. Then the robot has twice the play and another delay, and the comparison says so.
TEST(Fidelity, TellsALikeSessionFromAnother) {
  const FidelityProblem problem = quickProblem();
  const FidelityResult like = compareFidelity(simulateSession(problem.simulation, 30, 5), problem);
  EXPECT_EQ(like.trajectories, 6u);
  ASSERT_EQ(like.criteria.size(), 7u);
  for (const FidelityCriterion& criterion : like.criteria) {
    // Six trajectories hold few wrong orientations; six times two seconds tell a median to 15 %.
    if (criterion.name == "rejected by the rules of cleaning") continue;
    const double limit = criterion.unit == "ratio" ? 0.4 : criterion.limit;
    EXPECT_LE(std::abs(criterion.value), limit) << criterion.name;
  }
  EXPECT_NEAR(rowOf(like, "repeated observations").measured,
              rowOf(like, "repeated observations").simulated, 3.0);
  EXPECT_EQ(like.ladder.size(), 6u);
  for (const LadderStep& step : like.ladder) {
    EXPECT_LE(step.measured_position.lower, step.measured_position.value) << step.method;
    EXPECT_GE(step.measured_position.upper, step.measured_position.value) << step.method;
    EXPECT_LT(step.measured_position.lower, step.measured_position.upper) << step.method;
  }

  SimulationConfig other = problem.simulation;
  const auto changed = [&other](const char* effect, const char* symbol, double value) {
    std::unique_ptr<Effect> copy = other.find(effect)->clone();
    for (int i = 0; i < static_cast<int>(copy->parameters().size()); ++i)
      if (copy->parameters()[static_cast<std::size_t>(i)].symbol == symbol)
        copy->setValue(i, value);
    other.set(std::move(copy));
  };
  changed("command_delay", "tau", 0.2);
  changed("drive_friction", "w", 0.02);
  const FidelityResult unlike = compareFidelity(simulateSession(other, 30, 5), problem);
  int unmet = 0;
  for (const FidelityCriterion& criterion : unlike.criteria) {
    if (!criterion.met()) ++unmet;
    if (criterion.name == "delay") {
      EXPECT_FALSE(criterion.met()) << criterion.value;
    }
    if (criterion.name == "position after rigid fit, median") {
      EXPECT_FALSE(criterion.met()) << criterion.value;
    }
  }
  EXPECT_GE(unmet, 2);

  const nlohmann::json json = nlohmann::json::parse(fidelityJson(unlike));
  ASSERT_EQ(json["rows"].size(), unlike.rows.size());
  for (const auto& row : json["rows"]) {
    EXPECT_TRUE(row["quantity"].is_string() && row["unit"].is_string());
    EXPECT_TRUE(row["measured"].is_number() || row["measured"].is_null());
    EXPECT_TRUE(row["simulated"].is_number() || row["simulated"].is_null());
  }
  EXPECT_NE(fidelityText(unlike).find("NOT MET"), std::string::npos);
}

// Every figure is there, in the units that people read.
TEST(Fidelity, HasEveryFigure) {
  FidelityProblem problem = quickProblem();
  problem.training.process_enabled = false;
  const FidelityResult result =
      compareFidelity(simulateSession(problem.simulation, 15, 2), problem);
  const std::string text = fidelityText(result);
  for (const char* figure :
       {"position after rigid fit, median", "position after rigid fit, p95",
        "orientation after fixed rotations, median", "delay", "rejected: rotation_window",
        "rejected: least_median", "rejected: trajectory_rejected", "repeated observations",
        "observation interval, quantile 0.99", "position error, insertion",
        "orientation error, tool_roll", "position error, speed",
        "Table I, position, rigid_gp_velocity_clean", "Table I, orientation, none"})
    EXPECT_NE(text.find(figure), std::string::npos) << figure;
  EXPECT_THROW(compareFidelity(Dataset(), problem), InvalidInput);
}

}  // namespace
}  // namespace raven_correction
