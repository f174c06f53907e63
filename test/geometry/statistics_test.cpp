// SPDX-License-Identifier: BSD-3-Clause
#include "raven_correction/geometry/statistics.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <set>

#include "raven_correction/error.h"

namespace raven_correction {
namespace {

// The mean of n numbers is known to sd / sqrt(n), and so wide is its interval. A resampled sd of
// n = 200 has 5 % of its own, a quantile of 4000 resamples 3 %.
TEST(Bootstrap, IntervalOfAMeanIsThatOfTheory) {
  std::mt19937_64 engine(4);
  std::normal_distribution<double> normal(3.0, 2.0);
  std::vector<double> values(200);
  for (double& value : values) value = normal(engine);
  std::vector<double> means;
  bootstrapOverGroups(values.size(), 4000, 1, [&](const std::vector<std::size_t>& drawn) {
    ASSERT_EQ(drawn.size(), values.size());
    double sum = 0.0;
    for (const std::size_t i : drawn) sum += values.at(i);
    means.push_back(sum / static_cast<double>(drawn.size()));
  });
  ASSERT_EQ(means.size(), 4000u);
  const Interval interval = interval95(means);
  const double half = 1.96 * standardDeviation(values) / std::sqrt(200.0);
  EXPECT_NEAR(interval.upper - mean(values), half, 0.15 * half);
  EXPECT_NEAR(mean(values) - interval.lower, half, 0.15 * half);
}

TEST(Bootstrap, DrawsTheSameForTheSameSeedAndWithReplacement) {
  const auto draws = [](std::uint64_t seed) {
    std::vector<std::vector<std::size_t>> all;
    bootstrapOverGroups(12, 30, seed,
                        [&](const std::vector<std::size_t>& drawn) { all.push_back(drawn); });
    return all;
  };
  EXPECT_EQ(draws(7), draws(7));
  EXPECT_NE(draws(7), draws(8));
  const auto all = draws(7);
  const std::set<std::size_t> first(all.front().begin(), all.front().end());
  EXPECT_LT(first.size(), 12u) << "all of twelve in twelve draws: once in 18 000 times";
  EXPECT_LT(*first.rbegin(), 12u);
  bootstrapOverGroups(0, 5, 1, [](const std::vector<std::size_t>&) { FAIL(); });
  EXPECT_THROW(interval95({}), InvalidInput);
}

}  // namespace
}  // namespace raven_correction
