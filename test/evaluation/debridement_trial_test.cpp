// SPDX-License-Identifier: BSD-3-Clause
// Seconds per fragment, success and speed-up of scenes whose numbers are known.
#include "raven_correction/evaluation/debridement_trial.h"

#include <gtest/gtest.h>

#include <cmath>

#include "raven_correction/error.h"

namespace raven_correction {
namespace {

ClearedField fieldOf(std::uint64_t seed, unsigned fragments, unsigned delivered, double seconds) {
  ClearedField field;
  field.seed = seed;
  field.fragments = fragments;
  field.delivered = delivered;
  field.seconds = seconds;
  for (unsigned i = 0; i < fragments; ++i) {
    FragmentRecord record;
    record.picked = i < delivered;
    record.attempts = record.picked ? 1 : 4;
    record.end = 2.0;
    field.records.push_back(record);
  }
  return field;
}

TEST(DebridementTrial, CountsAndDivides) {
  const DebridementSummary s = summarise({fieldOf(1, 5, 4, 40.0), fieldOf(2, 5, 5, 50.0)}, 1);
  EXPECT_EQ(s.fragments, 10u);
  EXPECT_EQ(s.delivered, 9u);
  EXPECT_DOUBLE_EQ(s.seconds_per_fragment, 10.0);
  EXPECT_DOUBLE_EQ(s.success, 0.9);
  EXPECT_EQ(s.given_up, 1u);
  EXPECT_EQ(s.attempts, 13u);
  EXPECT_DOUBLE_EQ(s.retries, 0.3);
  EXPECT_EQ(s.first_try_held, 9u);
  EXPECT_DOUBLE_EQ(s.busy_per_fragment, 2.0);
  EXPECT_LE(s.success_interval.lower, 0.9);
  EXPECT_THROW(summarise({}, 1), InvalidInput);
}

TEST(DebridementTrial, SpeedUpIsOfTheSameScenes) {
  std::vector<ClearedField> slow, fast;
  for (std::uint64_t seed = 0; seed < 12; ++seed) {
    const double seconds = 100.0 + 40.0 * std::sin(static_cast<double>(seed));
    slow.push_back(fieldOf(seed, 6, 6, seconds));
    fast.push_back(fieldOf(seed, 6, 6, seconds / 4.0 + (seed % 2 == 0 ? 1.0 : -1.0)));
  }
  const PairedComparison result = *speedUp(slow, fast, 1);
  EXPECT_NEAR(result.value, 4.0, 0.05);
  EXPECT_LT(result.interval.lower, result.value);
  EXPECT_GT(result.interval.upper, result.value);
  // The scenes are drawn together, so how they differ does not widen the interval.
  EXPECT_LT(result.interval.upper - result.interval.lower, 0.4);
  fast[3].seed = 99;
  EXPECT_THROW(speedUp(slow, fast, 1), InvalidInput);
}

// A condition that delivered nothing is not left out, and loses no result.
TEST(DebridementTrial, NothingDeliveredIsNoSpeedAtAll) {
  const std::vector<ClearedField> some{fieldOf(1, 5, 5, 9.0)}, none{fieldOf(1, 5, 0, 9.0)};
  EXPECT_EQ(speedUp(some, none, 1)->value, 0.0);
  EXPECT_EQ(speedUp(some, none, 1)->interval.upper, 0.0);
  EXPECT_FALSE(speedUp(none, some, 1));
  EXPECT_FALSE(speedUp(none, none, 1));
}

TEST(DebridementTrial, SuccessIsComparedInTheSameScenes) {
  std::vector<ClearedField> reference, same, worse;
  for (std::uint64_t seed = 0; seed < 12; ++seed) {
    const unsigned delivered = 4 + seed % 3;  // scenes differ more than conditions
    reference.push_back(fieldOf(seed, 6, delivered, 9.0));
    same.push_back(fieldOf(seed, 6,
                           seed == 4   ? delivered + 1
                           : seed == 8 ? delivered - 1
                                       : delivered,
                           9.0));
    worse.push_back(fieldOf(seed, 6, delivered - 1, 9.0));
  }
  const PairedComparison equal = successDifference(reference, same, 1);
  EXPECT_DOUBLE_EQ(equal.value, 0.0);
  EXPECT_LT(equal.interval.lower, 0.0);
  EXPECT_GT(equal.interval.upper, 0.0);
  const PairedComparison lower = successDifference(reference, worse, 1);
  EXPECT_NEAR(lower.value, -1.0 / 6.0, 1e-12);
  EXPECT_LT(lower.interval.upper, -0.1);
}

}  // namespace
}  // namespace raven_correction
