// SPDX-License-Identifier: BSD-3-Clause
// Is a fit that tells how far it is the same fit, does it tell all the way, and does what the
// listener throws end it?
#include "raven_correction/regression/fit_progress.h"

#include <gtest/gtest.h>

#include <stdexcept>

#include "sample_problems.h"

namespace raven_correction {
namespace {

struct Stopped : std::runtime_error {  // as an exception that a line search might throw
  Stopped() : std::runtime_error("stopped") {}
};

class FitProgressTest : public ::testing::TestWithParam<HyperCriterion> {
 protected:
  FitProgressTest() {
    config_.criterion = GetParam();
    config_.backend = GpBackend::kExact;
    for (int i = 0; i < 300; ++i) groups_.push_back(i / 30);
  }
  GpFit fit(const FitProgress& progress) const {
    return fitGp(features_, targets_, config_, groups_, progress);
  }

  GpConfig config_;
  const Eigen::MatrixXd features_ = normalMatrix(300, 3, 1);
  const Eigen::MatrixXd targets_ = smoothTargets(features_) + 0.1 * normalMatrix(300, 2, 2);
  std::vector<int> groups_;
};

TEST_P(FitProgressTest, IsTheSameFitAndNeverFalls) {
  std::vector<double> told;
  const GpFit with = fit([&](double fraction) { told.push_back(fraction); });
  const GpFit without = fitGp(features_, targets_, config_, groups_);
  ASSERT_EQ(with.model.groups.size(), without.model.groups.size());
  for (std::size_t i = 0; i < with.model.groups.size(); ++i)
    EXPECT_EQ(with.model.groups[i].weights, without.model.groups[i].weights);
  ASSERT_GT(told.size(), 10u);
  EXPECT_GE(told.front(), 0.0);
  for (std::size_t i = 1; i < told.size(); ++i) EXPECT_GE(told[i], told[i - 1]);
  EXPECT_EQ(told.back(), 1.0);
}

TEST_P(FitProgressTest, WhatItThrowsEndsTheFitAtOnce) {
  for (const int last : {1, 2, 7, 12}) {
    int calls = 0;
    EXPECT_THROW(fit([&](double /*fraction*/) {
                   if (++calls == last) throw Stopped();
                 }),
                 Stopped);
    EXPECT_EQ(calls, last);
  }
}

INSTANTIATE_TEST_SUITE_P(Criteria, FitProgressTest,
                         ::testing::Values(HyperCriterion::kLikelihood,
                                           HyperCriterion::kValidation));

}  // namespace
}  // namespace raven_correction
