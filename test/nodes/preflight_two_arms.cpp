// SPDX-License-Identifier: BSD-3-Clause
// Both arms on one topic, each with a model that has to be checked: does the pre-flight of one arm
// say nothing about the other? The robot is this test, as in preflight.cpp.
#include <geometry_msgs/PoseStamped.h>
#include <gtest/gtest.h>
#include <std_srvs/SetBool.h>

#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "raven_correction/CorrectionModel.h"
#include "raven_correction/CorrectionStatus.h"
#include "raven_correction/Preflight.h"
#include "raven_correction/SetMode.h"
#include "raven_correction/ros/conversions.h"
#include "raven_correction/ros/model_file.h"
#include "raven_correction/ros/raven_command.h"
#include "support/call_meanwhile.h"
#include "support/node_main.h"
#include "support/promising_model.h"
#include "support/raven_bytes.h"
#include "support/spin_until.h"

namespace raven_correction {
namespace {

constexpr double kDelay = 0.02;     // of motion capture behind commands [s]
constexpr double kPatience = 40.0;  // for what takes a second on an idle machine [s]
constexpr std::size_t kLeft = 0, kRight = 1;
const std::array<std::string, 2> kSides = {"left", "right"};

Pose along(std::size_t arm, double t) {
  const double x = arm == kLeft ? 0.1 : -0.1;
  return {{x + 0.05 * std::sin(2.0 * t), 0.03 * std::cos(1.7 * t), -0.12 + 0.01 * std::sin(t)},
          expRotation({0.2 * std::sin(t), 0.0, 0.1})};
}

/// What turns an observed pose of an arm into the command that produced it.
Pose robotOf(std::size_t arm) {
  const double side = arm == kLeft ? 1.0 : -1.0;
  return {{side * 0.010, -0.004, 0.002}, expRotation({0.02, side * -0.05, 0.1})};
}

class PreflightOfTwoArms : public ::testing::Test {
 protected:
  PreflightOfTwoArms() {
    publisher_ = nh_.advertise<RavenCommand>("desired/servo_cp", 100);
    for (std::size_t i = 0; i < 2; ++i) {
      statuses_[i] = nh_.subscribe<CorrectionStatus>(
          kSides[i] + "/correction/status", 1000,
          [this, i](const CorrectionStatusConstPtr& message) { onStatus(i, *message); });
      models_[i] = nh_.advertise<CorrectionModel>(kSides[i] + "/correction/model", 1, true);
      mocap_[i] = nh_.advertise<geometry_msgs::PoseStamped>(kSides[i] + "/mocap/measured_cp", 1000);
    }
    EXPECT_TRUE(ros::service::waitForService("/raven/corrector/left/preflight", 30000));
    EXPECT_TRUE(spinUntil(
        [this] {
          bool all = publisher_.getNumSubscribers() == 1;
          for (std::size_t i = 0; i < 2; ++i)
            all &= models_[i].getNumSubscribers() == 1 && statuses_[i].getNumPublishers() == 1;
          return all;
        },
        kPatience));
    static int number = 0;
    ++number;
    for (std::size_t i = 0; i < 2; ++i) {
      Correction model =
          promisingModel(kSides[i] + "_" + std::to_string(number), robotOf(i), kDelay);
      model.arm = "raven2_" + kSides[i];
      models_[i].publish(modelToMsg(model));
      ids_[i] = model.id;
    }
    EXPECT_TRUE(set("", "off").success);
    // One that is too short to judge anything says which model it would be about.
    for (std::size_t i = 0; i < 2; ++i)
      EXPECT_TRUE(run([&] { return judge(i, 0.02).model == ids_[i]; }));
  }

  // --- the robot and its planner: one step every 5 ms
  void onStatus(std::size_t arm, const CorrectionStatus& status) {
    last_[arm] = status;
    geometry_msgs::PoseStamped seen;
    seen.header = status.header;
    seen.header.stamp += ros::Duration(kDelay);
    seen.pose = poseToMsg(robots_[arm].inverse() * poseFromMsg(status.command));
    mocap_[arm].publish(seen);
  }
  void step() {
    const ros::Time now = ros::Time::now();
    std::vector<ArmBytes> arms;
    for (std::size_t i = 0; i < 2; ++i) {
      arms.push_back(armBytes(i == kLeft ? "L" : "R",
                              kRavenPositionEnabled | kRavenOrientationEnabled,
                              along(i, now.toSec() - start_)));
    }
    RavenCommand message;
    message.bytes = command(arms, now.sec, now.nsec);
    publisher_.publish(message);
    ros::spinOnce();
  }
  template <typename Condition>
  bool run(Condition condition) {
    return waitFor(
        [&] {
          step();
          return condition();
        },
        kPatience);
  }

  // --- services, while the robot goes on
  template <typename Service>
  typename Service::Response call(const std::string& name, const Service& request) {
    return callMeanwhile(nh_, name, request, [this](auto until) { return run(until); });
  }
  Preflight::Response judge(std::size_t arm, double duration = 20.0) {
    Preflight service;
    service.request.duration = duration;
    return call("corrector/" + kSides[arm] + "/preflight", service);
  }
  /// @param of  "left/", "right/", or empty: of both
  SetMode::Response set(const std::string& of, const std::string& mode) {
    SetMode service;
    service.request.mode = mode;
    return call("corrector/" + of + "set_mode", service);
  }
  /// Of a pose that is sent from now on.
  bool says(std::size_t arm, std::uint8_t code) {
    const ros::Time now = ros::Time::now();
    return run([&] { return last_[arm].header.stamp > now && last_[arm].code == code; });
  }
  /// The same, but what it says first is all that counts.
  std::uint8_t codeOf(std::size_t arm) {
    const ros::Time now = ros::Time::now();
    EXPECT_TRUE(run([&] { return last_[arm].header.stamp > now; }));
    return last_[arm].code;
  }

  ros::NodeHandle nh_{"raven"};
  ros::Publisher publisher_;
  std::array<ros::Publisher, 2> models_, mocap_;
  std::array<ros::Subscriber, 2> statuses_;
  std::array<CorrectionStatus, 2> last_;
  std::array<std::string, 2> ids_;
  std::array<Pose, 2> robots_ = {robotOf(kLeft), robotOf(kRight)};
  const double start_ = ros::Time::now().toSec();
};

TEST_F(PreflightOfTwoArms, OneThatHasPassedMayBeSwitchedOnAlone) {
  const Preflight::Response left = judge(kLeft);
  EXPECT_TRUE(left.passed) << left.message;
  EXPECT_EQ(left.model, ids_[kLeft]);
  const SetMode::Response both = set("", "rigid");
  EXPECT_FALSE(both.success);
  EXPECT_NE(both.message.find("of right"), std::string::npos) << both.message;
  EXPECT_EQ(codeOf(kLeft), CorrectionStatus::PASSED_OFF) << "all or none";
  EXPECT_FALSE(set("right/", "rigid").success);
  EXPECT_TRUE(set("left/", "rigid").success);
  EXPECT_TRUE(says(kLeft, CorrectionStatus::RIGID_ONLY));
  EXPECT_EQ(codeOf(kRight), CorrectionStatus::PASSED_OFF);
  EXPECT_EQ(last_[kRight].preflight, CorrectionStatus::PREFLIGHT_NEEDED);
  const Preflight::Response right = judge(kRight);
  EXPECT_TRUE(right.passed) << right.message;
  EXPECT_EQ(right.model, ids_[kRight]);
  EXPECT_TRUE(set("", "rigid").success);
  EXPECT_TRUE(says(kRight, CorrectionStatus::RIGID_ONLY));
}

TEST_F(PreflightOfTwoArms, OneThatFailsLeavesTheOtherOn) {
  ASSERT_TRUE(judge(kLeft).passed);
  ASSERT_TRUE(judge(kRight).passed);
  ASSERT_TRUE(set("", "rigid").success);
  ASSERT_TRUE(says(kLeft, CorrectionStatus::RIGID_ONLY));
  ASSERT_TRUE(says(kRight, CorrectionStatus::RIGID_ONLY));
  robots_[kRight].p += robots_[kRight].q * Eigen::Vector3d(0.0, 0.008, 0.0);  // it was bumped
  const Preflight::Response right = judge(kRight);
  EXPECT_TRUE(right.success);
  EXPECT_FALSE(right.passed) << right.message;
  EXPECT_TRUE(says(kRight, CorrectionStatus::PASSED_OFF));
  EXPECT_EQ(codeOf(kLeft), CorrectionStatus::RIGID_ONLY);
  EXPECT_TRUE(judge(kLeft).passed);
  EXPECT_FALSE(set("", "rigid").success);
}

}  // namespace
}  // namespace raven_correction

int main(int argc, char** argv) {
  return raven_correction::runNodeTests(argc, argv, "test_preflight_two_arms");
}
