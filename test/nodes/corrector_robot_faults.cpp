// SPDX-License-Identifier: BSD-3-Clause
// Faults of doc/faults.md that have to do with the robot behind the corrector, as the Raven's CRTK
// branch is one: empty frames, its state, the limits of its controller. All others are
// corrector_faults.cpp.
#include <geometry_msgs/TransformStamped.h>
#include <gtest/gtest.h>

#include <cmath>
#include <optional>

#include "support/corrector_probe.h"
#include "support/node_main.h"
#include "support/operating_state.h"
#include "support/simple_model.h"

namespace raven_correction {
namespace {

// config/corrector.yaml
constexpr double kTranslationRate = 0.15, kRotationRate = 2.0, kMaxStepTime = 0.1;

const Pose kInBox{{0.01, 0.01, -0.03}, expRotation({0.02, 0.0, 0.01})};
const std::optional<Pose> kAtCommand;

class CrtkCorrectorFaults : public ::testing::Test {
 protected:
  using Probe = CorrectorProbe<geometry_msgs::TransformStamped>;

  void SetUp() override {
    measured_ = probe_.nh.advertise<geometry_msgs::TransformStamped>("measured_cp", 1);
    state_ = probe_.nh.advertise<RawMessage<OperatingStateType>>("operating_state", 1);
    probe_.publishModel(simpleModel());
    ASSERT_TRUE(probe_.until(
        [&] { return measured_.getNumSubscribers() == 1 && state_.getNumSubscribers() == 1; }));
  }
  /// Sends a pose with the robot in a state and its tool at a place (where it was sent, if none is
  /// given), until the condition holds.
  template <typename Condition>
  bool sendUntil(const Pose& pose, const std::string& state, bool homed,
                 const std::optional<Pose>& tool, Condition condition) {
    return probe_.until([&] {
      state_.publish(operatingState(state, homed));
      const Pose sent =
          probe_.statuses.empty() ? pose : poseFromMsg(probe_.statuses.back().command);
      measured_.publish(probe_.message(tool.value_or(sent), ""));
      return condition(probe_.send(probe_.message(pose, "")));
    });
  }

  Probe probe_{"crtk"};
  ros::Publisher measured_, state_;
};

TEST_F(CrtkCorrectorFaults, EmptyFrameIsTakenAndStaysEmpty) {
  probe_.commands.clear();
  EXPECT_TRUE(sendUntil(kInBox, "ENABLED", true, kAtCommand, [](const CorrectionStatus& status) {
    return status.code <= CorrectionStatus::CORRECTED_LIMITED;
  }));
  ASSERT_TRUE(probe_.until([&] { return !probe_.commands.empty(); }));
  EXPECT_EQ(probe_.commands.back().header.frame_id, "");
  EXPECT_EQ(probe_.commands.back().child_frame_id, "");
  probe_.expectRefused(probe_.message(kInBox, "elsewhere"), CorrectionStatus::REFUSED_FRAME, kInBox,
                       "");
}

TEST_F(CrtkCorrectorFaults, NothingIsCorrectedUnlessTheRobotIsEnabledAndHomed) {
  const auto corrected = [](const CorrectionStatus& status) {
    return status.code == CorrectionStatus::CORRECTED;
  };
  const auto passed = [](const CorrectionStatus& status) {
    return status.code == CorrectionStatus::PASSED_ROBOT_NOT_READY &&
           status.command == status.desired;
  };
  probe_.statuses.clear();
  EXPECT_TRUE(sendUntil(kInBox, "ENABLED", true, kAtCommand, corrected));
  EXPECT_TRUE(sendUntil(kInBox, "DISABLED", true, kAtCommand, passed));
  EXPECT_TRUE(sendUntil(kInBox, "ENABLED", true, kAtCommand, corrected));
  EXPECT_TRUE(sendUntil(kInBox, "ENABLED", false, kAtCommand, passed));
  EXPECT_TRUE(probe_.diagnosed([](const auto& status) {
    return status.message.find("not enabled and homed") != std::string::npos;
  }));
  EXPECT_TRUE(sendUntil(kInBox, "ENABLED", true, kAtCommand, corrected));
  // It was homed: a model from before may be off.
  EXPECT_TRUE(probe_.diagnosed([](const auto& status) {
    return status.message.find("after the model was trained the robot was homed") !=
           std::string::npos;
  }));
  EXPECT_TRUE(sendUntil(kInBox, "ENABLED", true, kAtCommand, corrected));
  // A robot that says nothing any more is not known to be ready.
  EXPECT_TRUE(probe_.until([&] { return passed(probe_.send(probe_.message(kInBox, ""))); }));
  expectStepsWithin(probe_.statuses, kTranslationRate, kRotationRate, kMaxStepTime);
}

TEST_F(CrtkCorrectorFaults, CorrectionIsReducedToTheStepTheRobotTakes) {
  // The tool is 10 mm behind the planner, the correction adds about as much in the same direction.
  Pose tool = kInBox;
  ASSERT_TRUE(sendUntil(kInBox, "ENABLED", true, kAtCommand, [](const CorrectionStatus& status) {
    return status.code == CorrectionStatus::CORRECTED;
  }));
  const Pose command = poseFromMsg(probe_.statuses.back().command);
  const Eigen::Vector3d direction = (command.p - kInBox.p).normalized();
  tool.p = kInBox.p - 0.010 * direction;
  EXPECT_TRUE(sendUntil(kInBox, "ENABLED", true, tool, [&](const CorrectionStatus& status) {
    return std::abs((poseFromMsg(status.command).p - tool.p).norm() - 0.015) < 1e-6 &&
           status.code == CorrectionStatus::CORRECTED_LIMITED &&
           (status.limits & CorrectionStatus::LIMIT_ROBOT_STEP) != 0;
  }));
  // Further than the robot takes by itself: the planner's own pose, and it is said.
  tool.p = kInBox.p - 0.020 * direction;
  EXPECT_TRUE(sendUntil(kInBox, "ENABLED", true, tool, [&](const CorrectionStatus& status) {
    return (poseFromMsg(status.command).p - tool.p).norm() < 0.020 + 1e-9 &&
           (status.limits & CorrectionStatus::PLANNER_BEYOND) != 0;
  }));
}

TEST_F(CrtkCorrectorFaults, MeasuredPosesWithoutAFreshStampAreNotBelieved) {
  // The tool is said to be 10 mm behind the planner, by poses that say nothing: the command is then
  // not within the robot's step of there, and diagnostics say by what the tool is known.
  ASSERT_TRUE(sendUntil(kInBox, "ENABLED", true, kAtCommand, [](const CorrectionStatus& status) {
    return status.code == CorrectionStatus::CORRECTED;
  }));
  const Pose command = poseFromMsg(probe_.statuses.back().command);
  Pose tool = kInBox;
  tool.p -= 0.010 * (command.p - kInBox.p).normalized();
  for (const double age : {0.0, 5.0, -30.0}) {
    geometry_msgs::TransformStamped measured = probe_.message(tool, "");
    measured.header.stamp -= ros::Duration(age);
    if (age == 0.0) measured.header.stamp = ros::Time(0);
    probe_.diagnostics.clear();
    EXPECT_TRUE(probe_.until([&] {
      state_.publish(operatingState("ENABLED", true));
      measured_.publish(measured);
      const CorrectionStatus status = probe_.send(probe_.message(kInBox, ""));
      EXPECT_LT((poseFromMsg(status.command).p - command.p).norm(), 1e-3) << age;
      for (const auto& said : probe_.diagnostics)
        if (said.level == diagnostic_msgs::DiagnosticStatus::WARN &&
            said.message.find("says where the tool is") != std::string::npos)
          return true;
      return false;
    })) << age;
  }
}

TEST_F(CrtkCorrectorFaults, CorrectionIsReducedToTheTurnTheRobotTakes) {
  Pose tool = kInBox;
  ASSERT_TRUE(sendUntil(kInBox, "ENABLED", true, kAtCommand, [](const CorrectionStatus& status) {
    return status.code == CorrectionStatus::CORRECTED;
  }));
  const Pose command = poseFromMsg(probe_.statuses.back().command);
  const Eigen::Vector3d turn = logRotation(kInBox.q.conjugate() * command.q);
  ASSERT_GT(turn.norm(), 0.05);
  tool.q = (kInBox.q * expRotation(-0.48 * turn.normalized())).normalized();
  EXPECT_TRUE(sendUntil(kInBox, "ENABLED", true, tool, [&](const CorrectionStatus& status) {
    return std::abs(rotationAngle(poseFromMsg(status.command).q, tool.q) - 0.5) < 1e-6 &&
           (status.limits & CorrectionStatus::LIMIT_ROBOT_STEP) != 0;
  }));
}

TEST_F(CrtkCorrectorFaults, CorrectionDoesNotLeaveTheBox) {
  const Pose border{{0.01, 0.01, -0.0155}, kInBox.q};  // the box ends at z = -0.015
  EXPECT_TRUE(sendUntil(border, "ENABLED", true, border, [&](const CorrectionStatus& status) {
    return std::abs(status.command.position.z + 0.015) < 1e-9 &&
           (status.limits & CorrectionStatus::LIMIT_BOX) != 0;
  }));
}

}  // namespace
}  // namespace raven_correction

int main(int argc, char** argv) {
  return raven_correction::runNodeTests(argc, argv, "test_corrector_robot_faults");
}
