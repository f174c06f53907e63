// SPDX-License-Identifier: BSD-3-Clause
// The statistics of Table II on visits whose mean error and scatter are known.
#include "raven_correction/evaluation/repeatability.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <set>

#include "raven_correction/error.h"

namespace raven_correction {
namespace {

Visit visitWith(const Eigen::Vector3d& position_error) {
  Visit visit;
  visit.error.components.head<3>() = position_error;
  visit.samples = 30;
  return visit;
}

TEST(Repeatability, TellsScatterOfOnePoseFromErrorsThatDifferBetweenPoses) {
  // Pose 0: errors 1 and 3 in x, mean 2; pose 1: -5 and -7, mean -6 [mm].
  std::vector<Visit> visits;
  for (const double x : {1e-3, -5e-3, 3e-3, -7e-3}) visits.push_back(visitWith({x, 0.0, 2e-3}));
  const RepeatabilityResult result = repeatability(visits, {0, 1, 0, 1});
  EXPECT_EQ(result.poses, 2u);
  EXPECT_EQ(result.visits, 4u);
  EXPECT_NEAR(result.errors.mean_abs(0), 4e-3, 1e-15);
  // Four deviations of 1 mm about the means, two degrees of freedom.
  EXPECT_NEAR(result.repeatability(0), std::sqrt(4.0 / 2.0) * 1e-3, 1e-15);
  EXPECT_NEAR(result.mean_error(0), std::sqrt((4.0 + 36.0) / 2.0) * 1e-3, 1e-15);
  EXPECT_EQ(result.repeatability(2), 0.0);
  EXPECT_NEAR(result.mean_error(2), 2e-3, 1e-15);
}

TEST(Repeatability, FindsTheDeviationOfTheNoise) {
  // Of 2000 poses visited 10 times: a deviation from 18 000 degrees of freedom is known to
  // 1 / sqrt(36 000) of itself. Five of these: chance alone fails one seed in a million.
  std::mt19937_64 random(3);
  std::normal_distribution<double> noise(0.0, 0.7e-3), offset(0.0, 20e-3);
  std::vector<Visit> visits;
  std::vector<std::size_t> pose;
  for (std::size_t j = 0; j < 2000; ++j) {
    const double mean = offset(random);
    for (int k = 0; k < 10; ++k) {
      visits.push_back(visitWith({mean + noise(random), 0.0, 0.0}));
      pose.push_back(j);
    }
  }
  EXPECT_NEAR(repeatability(visits, pose).repeatability(0), 0.7e-3,
              5.0 * 0.7e-3 / std::sqrt(36000.0));
}

TEST(Repeatability, LeavesOutWhatNobodySaw) {
  std::vector<Visit> visits{visitWith({1e-3, 0.0, 0.0}), visitWith({9.0, 0.0, 0.0})};
  visits[1].name = "t001";
  visits[1].samples = 0;
  const RepeatabilityResult result = repeatability(visits, {0, 0});
  EXPECT_EQ(result.visits, 1u);
  EXPECT_EQ(result.unseen, std::vector<std::string>{"t001"});
  EXPECT_EQ(result.repeatability(0), 0.0);
  EXPECT_NEAR(result.errors.mean_abs(0), 1e-3, 1e-15);
  visits[0].samples = 0;
  EXPECT_THROW(repeatability(visits, {0, 0}), InvalidInput);
  EXPECT_THROW(repeatability(visits, {0}), InvalidInput);
}

TEST(VisitOrder, VisitsEveryPoseInEveryRoundAndNeverTwiceInARow) {
  for (std::uint64_t seed = 0; seed < 50; ++seed)
    for (const std::size_t poses : {2u, 3u, 10u}) {
      const std::vector<std::size_t> order = visitOrder(poses, 10, seed);
      ASSERT_EQ(order.size(), 10 * poses);
      for (std::size_t i = 1; i < order.size(); ++i) ASSERT_NE(order[i], order[i - 1]);
      for (std::size_t k = 0; k < 10; ++k) {
        const auto first = order.begin() + static_cast<std::ptrdiff_t>(k * poses);
        ASSERT_EQ(std::set<std::size_t>(first, first + static_cast<std::ptrdiff_t>(poses)).size(),
                  poses);
      }
    }
  EXPECT_EQ(visitOrder(10, 10, 4), visitOrder(10, 10, 4));
  EXPECT_NE(visitOrder(10, 10, 4), visitOrder(10, 10, 5));
  EXPECT_EQ(visitOrder(1, 3, 4), (std::vector<std::size_t>{0, 0, 0}));
  EXPECT_THROW(visitOrder(0, 3, 4), InvalidInput);
  EXPECT_THROW(visitOrder(3, 0, 4), InvalidInput);
}

}  // namespace
}  // namespace raven_correction
