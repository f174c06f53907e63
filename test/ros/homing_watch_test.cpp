// SPDX-License-Identifier: BSD-3-Clause
#include "raven_correction/ros/homing_watch.h"

#include <gtest/gtest.h>

#include <cstring>

namespace raven_correction {
namespace {

using Homing = HomingWatch::Homing;
constexpr RobotState kHomed{true, true}, kNotHomed{false, false}, kDisabled{false, true};
constexpr double kLong = HomingWatch::kSilence + 0.1;

TEST(HomingWatch, OfTheTimeBeforeTheFirstStateNothingIsKnown) {
  HomingWatch watch;
  EXPECT_FALSE(watch.state().has_value());
  EXPECT_EQ(watch.update(kHomed, 1000.0), Homing::kNone);
  ASSERT_TRUE(watch.state().has_value());
  EXPECT_EQ(watch.at(), 1000.0);
}

TEST(HomingWatch, SeesAHoming) {
  HomingWatch watch;
  EXPECT_EQ(watch.update(kNotHomed, 10.0), Homing::kNone);
  EXPECT_EQ(watch.update(kHomed, 10.1), Homing::kSeen);
  EXPECT_EQ(watch.update(kHomed, 10.2), Homing::kNone);
  EXPECT_EQ(watch.update(kDisabled, 10.3), Homing::kNone) << "a brake does not home it";
  EXPECT_EQ(watch.update(kHomed, 10.4), Homing::kNone);
  EXPECT_EQ(watch.update(kNotHomed, 10.5), Homing::kNone);
  EXPECT_EQ(watch.update(kHomed, 10.5 + kLong), Homing::kSeen) << "silent in between, but clear";
}

TEST(HomingWatch, ASilenceMayHideOne) {
  HomingWatch watch;
  watch.update(kHomed, 10.0);
  EXPECT_EQ(watch.update(kHomed, 10.0 + HomingWatch::kSilence), Homing::kNone);
  EXPECT_EQ(watch.update(kHomed, 20.0), Homing::kPossible);
  EXPECT_EQ(watch.update(kHomed, 20.1), Homing::kNone) << "once";
  EXPECT_EQ(watch.update(kNotHomed, 30.0), Homing::kNone) << "it will be homed, and that is seen";
  EXPECT_STRNE(homingText(Homing::kSeen), homingText(Homing::kPossible));
}

TEST(HomingWatch, KnowsHowFarApartTheStatesAre) {
  HomingWatch watch(30.0);
  watch.update(kHomed, 10.0);
  EXPECT_EQ(watch.update(kHomed, 39.0), Homing::kNone);
  EXPECT_EQ(watch.update(kHomed, 70.0), Homing::kPossible);
  EXPECT_EQ(watch.update(kHomed, 20.0), Homing::kNone) << "the clock was set back";
}

}  // namespace
}  // namespace raven_correction
