// SPDX-License-Identifier: BSD-3-Clause
// Which parameters a corrector starts with, above all for two arms: nothing of one arm may be taken
// for the other. Whether a model is for an arm is test/ros/corrector_params_test.cpp.
#include "raven_correction/ros/corrector_params.h"

#include <gtest/gtest.h>

#include "raven_correction/error.h"
#include "support/node_main.h"

namespace raven_correction {
namespace {

class CorrectorParamsTest : public ::testing::Test {
 protected:
  CorrectorParamsTest() { clear(); }
  ~CorrectorParamsTest() override { clear(); }

  void clear() { ros::param::del("/case"); }
  void useTwoArms() {
    nh_.setParam("pose_type", "RavenCommand");
    nh_.setParam("arms", std::vector<std::string>{"L", "R"});
    nh_.setParam("arm_namespaces", std::vector<std::string>{"left", "right"});
    nh_.setParam("left/arm", "raven2_left");
    nh_.setParam("right/arm", "raven2_right");
  }
  /// The problems, one text; empty: the corrector starts.
  std::string problems() const {
    try {
      loadCorrectorParams(nh_);
    } catch (const InvalidInput& error) {
      return error.what();
    }
    return "";
  }
  bool complainsOf(const std::string& name, const std::string& text) const {
    const std::string all = problems();
    const auto line = all.find("~" + name + " ");
    return line != std::string::npos &&
           all.substr(line, all.find('\n', line) - line).find(text) != std::string::npos;
  }

  ros::NodeHandle nh_{"/case"};
};

TEST_F(CorrectorParamsTest, TheShippedFileHoldsTheDefaults) {
  const CorrectorParams shipped = loadCorrectorParams(ros::NodeHandle("/shipped"));
  const CorrectorParams defaults = loadCorrectorParams(nh_);
  EXPECT_EQ(shipped.pose_type, defaults.pose_type);
  EXPECT_EQ(shipped.limits.max_translation, defaults.limits.max_translation);
  EXPECT_EQ(shipped.limits.max_rotation, defaults.limits.max_rotation);
  EXPECT_EQ(shipped.limits.max_translation_rate, defaults.limits.max_translation_rate);
  EXPECT_EQ(shipped.limits.max_rotation_rate, defaults.limits.max_rotation_rate);
  EXPECT_EQ(shipped.limits.max_step_time, defaults.limits.max_step_time);
  EXPECT_EQ(shipped.limits.max_measured_age, defaults.limits.max_measured_age);
  EXPECT_EQ(shipped.realtime_priority, defaults.realtime_priority);
  EXPECT_EQ(shipped.require_preflight, defaults.require_preflight);
  EXPECT_EQ(shipped.preflight_duration, defaults.preflight_duration);
  EXPECT_EQ(shipped.preflight_poses, defaults.preflight_poses);
  EXPECT_EQ(shipped.preflight.factor, defaults.preflight.factor);
  EXPECT_EQ(shipped.preflight.max_position, defaults.preflight.max_position);
  EXPECT_EQ(shipped.preflight.max_angle, defaults.preflight.max_angle);
  EXPECT_EQ(shipped.mocap_pose_type, defaults.mocap_pose_type);
  EXPECT_EQ(shipped.mocap_stamp, defaults.mocap_stamp);
  ASSERT_EQ(shipped.arms.size(), 1u);
  EXPECT_EQ(shipped.arms[0].ns, "");
}

// What the controllers do: doc/faults.md, and the sources that the files name.
TEST_F(CorrectorParamsTest, TheFilesForRobotsHoldTheirLimits) {
  const CorrectorLimits crtk = loadCorrectorParams(ros::NodeHandle("/crtk")).limits;
  EXPECT_EQ(crtk.robot.max_step, 0.015);
  EXPECT_EQ(crtk.robot.max_turn, 0.5);
  EXPECT_EQ(crtk.box_min, Eigen::Vector3d(-0.03, -0.10, -0.20));
  EXPECT_EQ(crtk.box_max, Eigen::Vector3d(0.13, 0.15, -0.015));
  const CorrectorLimits berkeley = loadCorrectorParams(ros::NodeHandle("/berkeley")).limits;
  EXPECT_GT(berkeley.robot.max_step, 0.0);
  EXPECT_GT(berkeley.robot.max_turn, 0.0);
  EXPECT_GT(berkeley.max_measured_age, 2.0 * 0.1) << "two poses at 10 Hz";
  for (const char* const robot : {"/crtk", "/berkeley"})
    EXPECT_TRUE(loadCorrectorParams(ros::NodeHandle(robot)).require_preflight) << robot;
}

TEST_F(CorrectorParamsTest, OneArmHasTheParametersOfTheNode) {
  nh_.setParam("arm", "raven2_left");
  nh_.setParam("tool", "grasper_8mm");
  CorrectorParams params = loadCorrectorParams(nh_);
  ASSERT_EQ(params.arms.size(), 1u);
  EXPECT_EQ(params.arms[0].arm, "raven2_left");
  EXPECT_EQ(params.arms[0].tool, "grasper_8mm");
  // With a namespace its own come first.
  nh_.setParam("pose_type", "RavenCommand");
  nh_.setParam("arms", std::vector<std::string>{"L"});
  nh_.setParam("arm_namespaces", std::vector<std::string>{"left"});
  nh_.setParam("left/tool", "needle_driver");
  params = loadCorrectorParams(nh_);
  ASSERT_EQ(params.arms.size(), 1u);
  EXPECT_EQ(params.arms[0].name, "L");
  EXPECT_EQ(params.arms[0].arm, "raven2_left");
  EXPECT_EQ(params.arms[0].tool, "needle_driver");
}

TEST_F(CorrectorParamsTest, TwoArmsShareNothing) {
  useTwoArms();
  nh_.setParam("left/robot", "left.yaml");
  const CorrectorParams params = loadCorrectorParams(nh_);
  ASSERT_EQ(params.arms.size(), 2u);
  EXPECT_EQ(params.arms[0].arm, "raven2_left");
  EXPECT_EQ(params.arms[1].arm, "raven2_right");
  EXPECT_EQ(params.arms[0].robot, "left.yaml");
  EXPECT_EQ(params.arms[1].robot, "");
  for (const char* const name : {"arm", "tool", "model", "robot"}) {
    nh_.setParam(name, "something");
    EXPECT_TRUE(complainsOf(name, "is set for both arms; set ~left/")) << name << problems();
    nh_.deleteParam(name);
  }
  EXPECT_EQ(problems(), "");
}

TEST_F(CorrectorParamsTest, EachOfTwoArmsSaysWhoseModelsItTakes) {
  useTwoArms();
  nh_.deleteParam("right/arm");
  EXPECT_TRUE(complainsOf("right/arm", "is missing")) << problems();
  nh_.setParam("right/arm", "");
  EXPECT_TRUE(complainsOf("right/arm", "is missing")) << problems();
}

TEST_F(CorrectorParamsTest, EnabledAtTheStartContradictsAPreflight) {
  nh_.setParam("enabled", true);
  EXPECT_EQ(problems(), "");
  nh_.setParam("require_preflight", true);
  EXPECT_TRUE(complainsOf("enabled", "no model has passed a pre-flight")) << problems();
}

TEST_F(CorrectorParamsTest, AllProblemsAreListedAtOnce) {
  useTwoArms();
  nh_.setParam("arm_namespaces", std::vector<std::string>{"left"});
  nh_.setParam("gain", 2.0);
  nh_.setParam("max_translaton", 0.05);
  const std::string all = problems();
  for (const char* const part : {"~arm_namespaces", "1 entries for 2", "~gain", "~max_translaton",
                                 "did you mean max_translation?"})
    EXPECT_NE(all.find(part), std::string::npos) << part << " in " << all;
}

TEST_F(CorrectorParamsTest, NamesOfArmsAreChecked) {
  useTwoArms();
  nh_.setParam("arms", std::vector<std::string>{"L", "L"});
  EXPECT_TRUE(complainsOf("arms", "twice")) << problems();
  nh_.setParam("arms", std::vector<std::string>{"L", "R", "third"});
  EXPECT_TRUE(complainsOf("arms", "has 3 names")) << problems();
  nh_.setParam("arms", std::vector<std::string>());
  EXPECT_TRUE(complainsOf("arms", "has 0 names")) << problems();
  nh_.setParam("arms", std::vector<std::string>{"L", "R"});
  nh_.setParam("left/tol", "grasper_8mm");
  EXPECT_TRUE(complainsOf("left/tol", "did you mean left/tool?")) << problems();
  nh_.setParam("pose_type", "PoseStamped");
  EXPECT_TRUE(complainsOf("arms", "is for pose_type RavenCommand only")) << problems();
}

}  // namespace
}  // namespace raven_correction

int main(int argc, char** argv) {
  return raven_correction::runNodeTests(argc, argv, "test_corrector_params");
}
