// SPDX-License-Identifier: BSD-3-Clause
// Whether a model is for the arm that the parameters describe. Reading the parameters needs a
// master: test/nodes/corrector_params.cpp.
#include "raven_correction/ros/corrector_params.h"

#include <gtest/gtest.h>

#include "raven_correction/error.h"

namespace raven_correction {
namespace {

constexpr double kNow = 1e9;

Correction fitting() {
  Correction model;
  model.id = "m";
  model.frame = "0_link";
  model.arm = "raven2_left";
  model.tool = "grasper_8mm";
  model.pose_type = "PoseStamped";
  model.expires_at = kNow + 1.0;
  return model;
}

CorrectedArmParams arm() {
  CorrectedArmParams arm;
  arm.arm = "raven2_left";
  arm.tool = "grasper_8mm";
  return arm;
}

/// What is said of the model; empty: it is taken.
std::string complaint(const Correction& model, const CorrectedArmParams& arm) {
  try {
    checkModelIsFor(model, CorrectorParams(), arm, kNow);
  } catch (const InvalidInput& error) {
    return error.what();
  }
  return "";
}

bool says(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

TEST(CheckModelIsFor, TakesWhatFits) {
  EXPECT_EQ(complaint(fitting(), arm()), "");
  EXPECT_EQ(complaint(fitting(), CorrectedArmParams()), "") << "nothing is asked for";
  Correction unknown = fitting();
  unknown.arm = unknown.tool = unknown.pose_type = "";
  unknown.expires_at = 0.0;
  EXPECT_EQ(complaint(unknown, CorrectedArmParams()), "");
}

TEST(CheckModelIsFor, RefusesEveryOtherOrigin) {
  Correction other = fitting();
  other.frame = "1_link";
  EXPECT_TRUE(says(complaint(other, arm()), "frame \"1_link\""));
  other = fitting();
  other.arm = "raven2_right";
  EXPECT_TRUE(says(complaint(other, arm()), "arm \"raven2_right\""));
  other = fitting();
  other.tool = "needle_driver";
  EXPECT_TRUE(says(complaint(other, arm()), "tool \"needle_driver\""));
  other = fitting();
  other.pose_type = "RavenCommand";
  EXPECT_TRUE(says(complaint(other, arm()), "message type \"RavenCommand\""));
  other = fitting();
  other.expires_at = kNow - 3600.0;
  EXPECT_TRUE(says(complaint(other, arm()), "expired 1.0 h ago"));
}

TEST(CheckModelIsFor, RefusesWhatDoesNotSayForWhichArmOrTool) {
  Correction unnamed = fitting();
  unnamed.arm = "";
  EXPECT_TRUE(says(complaint(unnamed, arm()), "does not say for which arm"));
  unnamed = fitting();
  unnamed.tool = "";
  EXPECT_TRUE(says(complaint(unnamed, arm()), "does not say for which tool"));
}

}  // namespace
}  // namespace raven_correction
