// SPDX-License-Identifier: BSD-3-Clause
#include "raven_correction/report/table_one_html.h"

#include <cmath>
#include <map>
#include <nlohmann/json.hpp>

#include "raven_correction/error.h"
#include "raven_correction/report/table_one_report.h"
#include "raven_correction/simulation/session.h"
#include "report/page.h"
#include "report/quick_training.h"

namespace raven_correction {
namespace {

struct Evaluated {
  Dataset dataset;
  TableOneResult table;
  ErrorSamples samples;
  std::string page;
};
const Evaluated& evaluated() {
  static const Evaluated* const result = [] {
    auto* const all = new Evaluated;
    all->dataset =
        simulateSession(loadSimulationConfig("config/simulation/raven2_left_case2014.yaml"), 10, 3);
    TableOneProblem problem;
    // Two configurations whose numbers differ everywhere, or a page could mix them up unseen.
    TrainingConfig other = quickTraining();
    other.estimate_delay = false;
    other.fixed_delay = 0.0;
    problem.configurations = {{"paper", other}, {"best", quickTraining()}};
    problem.observer = all->samples.observer();
    all->table = crossValidate(all->dataset, problem);
    all->page =
        withPlainSpaces(tableOneHtml(all->table, all->samples, streamHealth(all->dataset), {}));
    return all;
  }();
  return *result;
}

TEST(TableOneHtml, IsOneWellFormedFileWithoutAnythingOutside) {
  EXPECT_EQ(problemsOf(evaluated().page), "");
  EXPECT_LT(evaluated().page.size(), 1000000u);
  EXPECT_LT(evaluated().page.find("What to do next"), evaluated().page.find("<figure>"));
  EXPECT_EQ(count(evaluated().page, "<em>Good:</em>"), count(evaluated().page, "<figure>"));
}

TEST(TableOneHtml, SaysTheNumbersOfTheJson) {
  const auto json = nlohmann::json::parse(tableOneJson(evaluated().table));
  const auto number = [](const nlohmann::json& value) {
    return format("%.2f", value.get<double>());
  };
  // Of the mean over folds: configuration and test set, then row by row the six methods.
  std::map<std::pair<std::string, std::string>, std::map<std::string, std::vector<std::string>>>
      tables;
  for (const auto& row : json["rows"]) {
    if (row["fold"] != "mean") continue;
    auto& table = tables[{row["configuration"], row["test_set"]}];
    const std::pair<const char*, const char*> keys[] = {{"norm [mm]", "position_norm_mm"},
                                                        {"norm [deg]", "angle_norm_deg"},
                                                        {"median [mm]", "position_median_mm"},
                                                        {"p95 [mm]", "position_p95_mm"},
                                                        {"mean angle [deg]", "angle_mean_deg"}};
    for (const auto& [name, key] : keys) table[name].push_back(number(row[key]));
    table["tx [mm]"].push_back(number(row["mean_abs"]["tx_mm"]) + " \xC2\xB1 " +
                               number(row["std"]["tx_mm"]));
  }
  ASSERT_EQ(tables.size(), 4u);
  for (const auto& [which, rows] : tables) {
    const std::string caption =
        format("%s test set, configuration &quot;%s&quot;",
               which.second == "clean" ? "Clean" : "Dirty", which.first.c_str());
    const std::string table = tableUnder(evaluated().page, caption);
    ASSERT_FALSE(table.empty()) << caption;
    for (const auto& [name, numbers] : rows) {
      EXPECT_EQ(numbers.size(), 6u);
      EXPECT_TRUE(contains(table, rowOf(name, numbers))) << caption << ", " << name;
    }
  }
  EXPECT_NE(tables[std::make_pair("paper", "clean")], tables[std::make_pair("best", "clean")]);
  for (const auto& [reason, rejected] : json["cleaning"]["rejected"].items())
    EXPECT_TRUE(contains(evaluated().page, reason + "</td><td class=\"number\">" +
                                               std::to_string(rejected.get<int>())));
}

TEST(TableOneHtml, PrintsThePaperBesideIt) {
  EXPECT_TRUE(contains(evaluated().page, "17.4 \xC2\xB1 2.6"));
  EXPECT_TRUE(contains(evaluated().page, "as printed in the paper"));
}

TEST(ErrorSamples, ComeToTheTable) {
  const ErrorSeries& series = evaluated().samples.find("best", Method::kRigidGpVelocityClean, true);
  const ErrorSummary& row =
      evaluated().table.row("best", Method::kRigidGpVelocityClean, true, kMeanOfFolds).errors;
  EXPECT_EQ(series.position.size(), row.n);
  EXPECT_EQ(series.standardised.size(), row.n);
  EXPECT_TRUE(evaluated().samples.find("best", Method::kRigid, true).standardised.empty());
  EXPECT_THROW(evaluated().samples.find("nothing", Method::kRigid, true), InvalidInput);
}

// Normal numbers fill normal intervals.
TEST(CoverageOf, NormalNumbersIsTheDiagonal) {
  std::vector<Eigen::Matrix<double, 6, 1>> standardised;
  const int n = 4000;
  for (int i = 0; i < n; ++i) {
    // Inverse of the normal distribution at (i + 1/2) / n, by bisection.
    double lower = -8.0, upper = 8.0;
    for (int k = 0; k < 60; ++k) {
      const double middle = 0.5 * (lower + upper);
      (0.5 * std::erfc(-middle / std::sqrt(2.0)) < (i + 0.5) / n ? lower : upper) = middle;
    }
    standardised.emplace_back(Eigen::Matrix<double, 6, 1>::Constant(lower));
  }
  const CoverageCurve curve = coverageOf(standardised);
  for (std::size_t k = 0; k < curve.nominal.size(); ++k)
    EXPECT_NEAR(curve.observed(static_cast<Eigen::Index>(k), 4), curve.nominal[k], 1.0 / n);
  for (auto& z : standardised) z *= 2.0;  // deviations half as large as the errors
  EXPECT_LT(coverageOf(standardised).observed(9, 0), 0.35);
  EXPECT_TRUE(coverageOf({}).nominal.empty());
}

}  // namespace
}  // namespace raven_correction
