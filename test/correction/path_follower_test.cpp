// SPDX-License-Identifier: BSD-3-Clause
// Does the follower know where the stream will be, and does it say nothing wherever stream and path
// do not agree?
#include "raven_correction/correction/path_follower.h"

#include <gtest/gtest.h>

#include <cmath>

namespace raven_correction {
namespace {

constexpr double kStart = 1000.0;  // [s]
constexpr double kPeriod = 0.02;   // of the stream [s]

Pose at(double i) {
  return {{0.001 * i, 0.02 * std::sin(0.05 * i), 0.0}, expRotation({0.0, 0.0, 0.01 * i})};
}

class PathFollowerTest : public ::testing::Test {
 protected:
  void announce(int poses) {
    follower_.begin();
    for (int i = 0; i < poses; ++i) follower_.add(at(i));
  }
  void send(int i, double late = 0.0) { follower_.follow(kStart + kPeriod * i + late, at(i)); }
  void expectAhead(double lead, double index) {
    const auto ahead = follower_.ahead(lead);
    ASSERT_TRUE(ahead.has_value());
    // Linear between poses of a curve that bends by less than 1e-5 m in a period.
    EXPECT_LT((ahead->p - at(index).p).norm(), 2e-5);
    EXPECT_LT(rotationAngle(ahead->q, at(index).q), 1e-6);
  }

  PathFollower follower_;
};

TEST_F(PathFollowerTest, KnowsWhereTheStreamWillBe) {
  announce(200);
  EXPECT_FALSE(follower_.ahead(0.1).has_value());  // nothing has come
  send(0);
  EXPECT_FALSE(follower_.ahead(0.1).has_value());  // how fast it goes is not known
  for (int i = 1; i < 150; ++i) {
    send(i, i % 2 == 0 ? 0.003 : 0.0);  // stamps jitter
    expectAhead(0.0, i);
    const auto ahead = follower_.ahead(0.15);
    ASSERT_TRUE(ahead.has_value());
    if (i > 20) {
      EXPECT_LT((ahead->p - at(i + 7.5).p).norm(), 5e-4) << i;
    }
  }
  for (int i = 150; i < 200; ++i) send(i);
  expectAhead(0.15, 199);  // at its end it rests
}

TEST_F(PathFollowerTest, GoesOnWherePosesWereSkipped) {
  announce(200);
  for (int i = 0; i < 100; i += 1 + i % 4) {
    send(i);
    if (i > 0) expectAhead(0.1, i + 5);
  }
}

TEST_F(PathFollowerTest, KnowsWhereItIsInARest) {
  follower_.begin();
  for (int i = 0; i < 20; ++i) follower_.add(at(0));
  for (int i = 0; i < 100; ++i) follower_.add(at(i));
  for (int i = 0; i < 20; i += i == 10 ? 3 : 1)  // two are skipped in the middle of the rest
    follower_.follow(kStart + kPeriod * i, at(0));
  const auto ahead = follower_.ahead(10 * kPeriod);
  ASSERT_TRUE(ahead.has_value());
  EXPECT_LT((ahead->p - at(9).p).norm(), 1e-9);
}

TEST_F(PathFollowerTest, SaysNothingOfAStreamThatIsNotOnThePath) {
  EXPECT_FALSE(follower_.ahead(0.1).has_value());  // no path
  announce(200);
  for (int i = 0; i < 10; ++i) send(i);
  Pose other = at(10);
  other.p.z() += 1e-4;  // the planner stops, or somebody moves the goal
  follower_.follow(kStart + kPeriod * 10, other);
  EXPECT_FALSE(follower_.ahead(0.1).has_value());
  for (int i = 11; i < 50; ++i) send(i);  // not even where it comes back
  EXPECT_FALSE(follower_.ahead(0.1).has_value());
  announce(200);
  for (int i = 0; i < 10; ++i) send(i);
  EXPECT_TRUE(follower_.ahead(0.1).has_value());
}

TEST_F(PathFollowerTest, SaysNothingOfAnOldPath) {
  announce(100);
  for (int i = 0; i < 100; ++i) send(i);
  EXPECT_TRUE(follower_.ahead(0.1).has_value());
  for (int i = 100; i < 120; ++i) send(i);  // the next motion, whose path nobody has announced
  EXPECT_FALSE(follower_.ahead(0.1).has_value());
}

TEST_F(PathFollowerTest, LearnsThePaceAnewAfterAPause) {
  announce(200);
  for (int i = 0; i < 20; ++i) send(i);
  send(20, 0.5);
  EXPECT_FALSE(follower_.ahead(0.1).has_value());
  for (int i = 21; i < 30; ++i) send(i, 0.5);
  expectAhead(0.1, 29 + 5);
}

TEST_F(PathFollowerTest, TakesBackAPoseThatDidNotCount) {
  announce(200);
  for (int i = 0; i < 20; ++i) send(i);
  follower_.follow(kStart + kPeriod * 20, at(150));
  EXPECT_FALSE(follower_.ahead(0.1).has_value());
  follower_.undo();
  expectAhead(0.1, 19 + 5);
  send(20);
  expectAhead(0.1, 20 + 5);
}

TEST_F(PathFollowerTest, KnowsNothingOfAPathThatIsTooLong) {
  announce(static_cast<int>(PathFollower::kCapacity) + 1);
  for (int i = 0; i < 20; ++i) send(i);
  EXPECT_FALSE(follower_.ahead(0.1).has_value());
}

}  // namespace
}  // namespace raven_correction
