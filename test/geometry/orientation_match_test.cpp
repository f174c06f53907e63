// SPDX-License-Identifier: BSD-3-Clause
#include "raven_correction/geometry/orientation_match.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "raven_correction/geometry/pose.h"
#include "support/random_poses.h"

namespace raven_correction {
namespace {

using Orientations = std::vector<Eigen::Quaterniond>;

/// A tool that is tilted and turned, slowly.
Orientations motion(double about_y = 0.4) {
  Orientations orientations;
  for (int i = 0; i < 200; ++i) {
    const double t = 0.05 * i;
    orientations.push_back(expRotation(
        {0.5 * std::sin(t), 1.0 + about_y * std::cos(1.3 * t), 0.6 * std::sin(0.7 * t)}));
  }
  return orientations;
}

/// As a reader gets it that has w last.
Eigen::Quaterniond writtenWithWFirst(const Eigen::Quaterniond& q) {
  Eigen::Quaterniond read;
  read.coeffs() = Eigen::Vector4d(q.w(), q.x(), q.y(), q.z());
  return read;
}

TEST(OrientationMatch, TellsAnotherFrameFromAnotherOrder) {
  std::mt19937_64 random(3);
  const Orientations told = motion();
  for (int i = 0; i < 200; ++i) {
    const Eigen::Quaterniond base = expRotation(randomVector(random, 1.5)),
                             marker = expRotation(randomVector(random, 1.5));
    Orientations turned, other_order, inverse;
    for (const Eigen::Quaterniond& q : told) {
      turned.push_back(base * q * marker * expRotation(randomVector(random, 0.01)));
      if (i % 2 == 0) turned.back().coeffs() *= -1.0;
      other_order.push_back(base * writtenWithWFirst(turned.back()));
      inverse.push_back(turned.back().conjugate());
    }
    EXPECT_LT(matchOrientations(told, turned).turned, 0.03);
    EXPECT_GT(matchOrientations(told, turned).mirrored, 0.1);
    for (const Orientations& wrong : {other_order, inverse}) {
      EXPECT_LT(matchOrientations(told, wrong).mirrored, 0.03);
      EXPECT_GT(matchOrientations(told, wrong).turned, 0.1);
    }
  }
}

TEST(OrientationMatch, TellsNothingWhereNothingTurns) {
  const Orientations told(100, expRotation({0.1, 0.2, 0.3}));
  const OrientationMatch match =
      matchOrientations(told, Orientations(100, expRotation({1.0, 0.0, 0.0})));
  EXPECT_NEAR(match.turned, 0.0, 1e-7);
  EXPECT_NEAR(match.mirrored, 0.0, 1e-7);
  EXPECT_EQ(matchOrientations({}, {}).turned, 0.0);
}

TEST(OrientationMatch, OutliersDoNotDecide) {
  std::mt19937_64 random(4);
  const Orientations told = motion();
  Orientations seen;
  for (const Eigen::Quaterniond& q : told)
    seen.push_back(seen.size() % 10 == 0 ? randomPose(random, 1.0).q
                                         : expRotation({0.3, -1.0, 0.8}) * q);
  EXPECT_LT(matchOrientations(told, seen).turned, 0.2);
  EXPECT_GT(matchOrientations(told, seen).mirrored, 2.0 * matchOrientations(told, seen).turned);
}

}  // namespace
}  // namespace raven_correction
