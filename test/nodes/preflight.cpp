// SPDX-License-Identifier: BSD-3-Clause
// Before a model may correct, a few moves have to show that it is valid for the robot today. The
// robot is this test: it moves as it is commanded, off by a rigid transform, and motion capture
// sees it.
#include "raven_correction/Preflight.h"

#include <geometry_msgs/PoseStamped.h>
#include <gtest/gtest.h>

#include <cmath>
#include <future>

#include "support/call_meanwhile.h"
#include "support/corrector_probe.h"
#include "support/node_main.h"
#include "support/operating_state.h"
#include "support/promising_model.h"

namespace raven_correction {
namespace {

constexpr double kDelay = 0.02;        // of motion capture behind commands [s]
constexpr double kStateTimeout = 5.0;  // robot_state_timeout of preflight.test [s]
constexpr double kPatience = 40.0;     // for what takes a second on an idle machine [s]

/// What turns an observed pose into the command that produced it.
const Pose kRobot{{0.010, -0.004, 0.002}, expRotation({0.02, -0.05, 0.1})};

Pose along(double t) {
  return {{0.05 * std::sin(2.0 * t), 0.03 * std::cos(1.7 * t), -0.12 + 0.01 * std::sin(t)},
          expRotation({0.2 * std::sin(t), 0.0, 0.1})};
}

class PreflightFaults : public ::testing::Test {
 protected:
  PreflightFaults()
      : mocap_(probe_.nh.advertise<geometry_msgs::PoseStamped>("mocap/measured_cp", 1000)),
        state_(probe_.nh.advertise<RawMessage<OperatingStateType>>("operating_state", 1)) {}

  /// Every test begins with a robot that was homed just now, and a model that nobody has checked.
  void SetUp() override {
    ASSERT_TRUE(run([&] { return state_.getNumSubscribers() == 1; }));
    home();
    give(freshModel());
    ASSERT_TRUE(saysValue("model", model_id_));
    ASSERT_TRUE(saysPreflight(CorrectionStatus::PREFLIGHT_NEEDED));
  }

  // --- the robot and its planner: one step every 5 ms
  void step() {
    const ros::Time now = ros::Time::now();
    if (moves_) probe_.publisher.publish(probe_.message(along(now.toSec() - start_)));
    if (tells_) state_.publish(operatingState("ENABLED", homed_));
    ++states_;
    ros::spinOnce();
    for (; seen_ < probe_.commands.size(); ++seen_) {
      geometry_msgs::PoseStamped seen = probe_.commands[seen_];
      seen.header.stamp += ros::Duration(kDelay);
      Pose pose = robot_.inverse() * poseFromMsg(seen.pose);
      pose.p *= metres_;
      seen.pose = poseToMsg(pose);
      if (sees_) mocap_.publish(seen);
      if (!repeats_ || seen_ % 50 != 0) continue;
      seen.header.stamp -= ros::Duration(1.0);  // a second node sends old poses there
      mocap_.publish(seen);
    }
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
  void home() {
    // Each until the corrector knows it; that it knows nothing looks like not homed.
    for (const bool homed : {true, false, true}) {
      homed_ = homed;
      EXPECT_TRUE(diagnosed([homed](const auto& status) {
        return homed == (status.message.find("not enabled and homed") == std::string::npos);
      }));
    }
    EXPECT_TRUE(saysPreflight(CorrectionStatus::PREFLIGHT_NEEDED));
  }
  Correction freshModel() {
    static int count = 0;
    model_id_ = "model_" + std::to_string(++count);
    return promisingModel(model_id_, kRobot, kDelay);
  }
  void give(const Correction& model) { probe_.publishModel(model); }

  // --- what is seen of the corrector
  CorrectionStatus lastStatus() const {
    return probe_.statuses.empty() ? CorrectionStatus() : probe_.statuses.back();
  }
  template <typename Condition>
  bool says(Condition condition) {
    probe_.statuses.clear();
    return run([&] { return !probe_.statuses.empty() && condition(probe_.statuses.back()); });
  }
  bool saysPreflight(std::uint8_t preflight) {
    return says([&](const CorrectionStatus& status) { return status.preflight == preflight; });
  }
  bool saysCode(std::uint8_t code) {
    return says([&](const CorrectionStatus& status) { return status.code == code; });
  }
  bool corrects(const std::string& model) {
    return says([&](const CorrectionStatus& status) {
      return status.code == CorrectionStatus::RIGID_ONLY && status.model == model;
    });
  }
  template <typename Condition>
  bool diagnosed(Condition condition) {
    probe_.diagnostics.clear();
    return run([&] {
      for (const auto& status : probe_.diagnostics)
        if (condition(status)) return true;
      return false;
    });
  }
  bool saysValue(const std::string& key, const std::string& value) {
    return diagnosed([&](const auto& status) {
      for (const auto& said : status.values)
        if (said.key == key && said.value == value) return true;
      return false;
    });
  }
  bool warns(const std::string& text) {
    return diagnosed([&](const auto& status) {
      return status.level == diagnostic_msgs::DiagnosticStatus::WARN &&
             status.message.find(text) != std::string::npos;
    });
  }

  // --- services, while the robot goes on
  template <typename Service>
  typename Service::Response call(const std::string& name, const Service& request) {
    return callMeanwhile(probe_.nh, name, request, [this](auto until) { return run(until); });
  }
  Preflight::Response preflight(double duration = 20.0) {
    Preflight service;
    service.request.duration = duration;
    return call("corrector/preflight", service);
  }
  /// One that runs when this returns, as a second one that is refused shows.
  std::future<Preflight::Response> beginPreflight() {
    const auto begin = [&] {
      Preflight service;
      service.request.duration = 20.0;
      return beginCall(probe_.nh, "corrector/preflight", service);
    };
    auto first = begin();
    Preflight::Response second;
    EXPECT_TRUE(run([&] {
      if (isReady(first)) first = begin();  // it may have come in second itself
      second = preflight(0.2);
      return second.message.find("a pre-flight is running") != std::string::npos;
    })) << second.message;
    return first;
  }
  SetMode::Response setMode(const std::string& mode, bool override_preflight = false) {
    SetMode service;
    service.request.mode = mode;
    service.request.override_preflight = override_preflight;
    return call("corrector/set_mode", service);
  }
  std_srvs::SetBool::Response enable(bool on) {
    std_srvs::SetBool service;
    service.request.data = on;
    return call("corrector/enable", service);
  }

  CorrectorProbe<geometry_msgs::PoseStamped> probe_{"arm"};
  ros::Publisher mocap_, state_;
  const double start_ = ros::Time::now().toSec();
  std::size_t seen_ = 0;
  int states_ = 0;
  bool moves_ = true, homed_ = true, sees_ = true, tells_ = true, repeats_ = false;
  double metres_ = 1.0;
  Pose robot_ = kRobot;
  std::string model_id_;
};

TEST_F(PreflightFaults, NothingIsSwitchedOnBeforeAPreflight) {
  const auto enabled = enable(true);
  EXPECT_FALSE(enabled.success);
  EXPECT_NE(enabled.message.find("~preflight"), std::string::npos) << enabled.message;
  EXPECT_NE(enabled.message.find("override_preflight"), std::string::npos) << enabled.message;
  EXPECT_FALSE(setMode("rigid").success);
  EXPECT_TRUE(saysCode(CorrectionStatus::PASSED_OFF));
  EXPECT_TRUE(setMode("off").success) << "off is always taken";
}

TEST_F(PreflightFaults, AValidModelPassesAndMayBeSwitchedOn) {
  const Preflight::Response judged = preflight();
  EXPECT_TRUE(judged.success && judged.passed) << judged.message;
  EXPECT_EQ(judged.model, model_id_);
  EXPECT_GE(judged.poses, 30u);
  // Nothing but interpolation between commands is left of the error.
  EXPECT_LT(judged.position_median_mm, 0.2);
  EXPECT_LT(judged.orientation_median_deg, 0.2);
  EXPECT_GT(judged.position_before_mm, 5.0);
  EXPECT_NEAR(judged.position_expected_mm, 0.5, 1e-9);
  EXPECT_NEAR(judged.position_limit_mm, 3.0, 1e-9);
  EXPECT_TRUE(judged.findings.empty()) << judged.findings[0];
  EXPECT_TRUE(saysPreflight(CorrectionStatus::PREFLIGHT_PASSED));
  EXPECT_TRUE(saysCode(CorrectionStatus::PASSED_OFF)) << "passing switches nothing on";
  EXPECT_TRUE(enable(true).success);
  EXPECT_TRUE(corrects(model_id_));
}

TEST_F(PreflightFaults, AModelThatIsFarOffFailsAndIsSwitchedOff) {
  ASSERT_TRUE(preflight().passed);
  ASSERT_TRUE(enable(true).success);
  ASSERT_TRUE(corrects(model_id_));
  robot_.p += robot_.q * Eigen::Vector3d(0.0, 0.008, 0.0);  // the cameras were bumped
  const Preflight::Response judged = preflight();
  EXPECT_TRUE(judged.success);
  EXPECT_FALSE(judged.passed) << judged.message;
  EXPECT_NEAR(judged.position_median_mm, 8.0, 0.3);
  EXPECT_NE(judged.message.find("not valid for this robot today"), std::string::npos);
  EXPECT_TRUE(saysCode(CorrectionStatus::PASSED_OFF));
  EXPECT_FALSE(enable(true).success);
}

TEST_F(PreflightFaults, AnotherModelWaitsWhileTheCheckedOneGoesOn) {
  const std::string checked = model_id_;
  const Correction first = promisingModel(checked, kRobot, kDelay);
  ASSERT_TRUE(preflight().passed);
  ASSERT_TRUE(enable(true).success);
  ASSERT_TRUE(corrects(checked));
  give(freshModel());
  EXPECT_TRUE(warns("model " + model_id_ + " waits for its pre-flight"));
  EXPECT_TRUE(corrects(checked));
  const Preflight::Response judged = preflight();
  EXPECT_TRUE(judged.passed) << judged.message;
  EXPECT_EQ(judged.model, model_id_);
  EXPECT_TRUE(corrects(model_id_));
  // Going back to one that has passed needs nothing.
  give(first);
  EXPECT_TRUE(corrects(checked));
}

TEST_F(PreflightFaults, AHomingSwitchesOffUntilTheNextPreflight) {
  ASSERT_TRUE(preflight().passed);
  ASSERT_TRUE(enable(true).success);
  ASSERT_TRUE(corrects(model_id_));
  homed_ = false;
  EXPECT_TRUE(saysCode(CorrectionStatus::PASSED_ROBOT_NOT_READY));
  homed_ = true;
  EXPECT_TRUE(saysCode(CorrectionStatus::PASSED_OFF));
  EXPECT_TRUE(saysPreflight(CorrectionStatus::PREFLIGHT_NEEDED));
  EXPECT_TRUE(warns("the robot was homed: the correction is off until a pre-flight has passed"));
  EXPECT_FALSE(enable(true).success);
  EXPECT_TRUE(preflight().passed);
  EXPECT_TRUE(enable(true).success);
  EXPECT_TRUE(corrects(model_id_));
}

TEST_F(PreflightFaults, ASilenceOfTheRobotsStateMayHideAHoming) {
  ASSERT_TRUE(preflight().passed);
  ASSERT_TRUE(enable(true).success);
  ASSERT_TRUE(corrects(model_id_));
  tells_ = false;
  const ros::SteadyTime heard = ros::SteadyTime::now();
  ASSERT_TRUE(run([&] { return (ros::SteadyTime::now() - heard).toSec() > kStateTimeout + 0.5; }));
  EXPECT_TRUE(saysCode(CorrectionStatus::PASSED_ROBOT_NOT_READY));
  tells_ = true;
  EXPECT_TRUE(saysPreflight(CorrectionStatus::PREFLIGHT_NEEDED));
  EXPECT_TRUE(saysCode(CorrectionStatus::PASSED_OFF));
  EXPECT_TRUE(warns("may have been homed while its state was silent"));
  EXPECT_TRUE(preflight().passed);
  EXPECT_TRUE(enable(true).success);
}

TEST_F(PreflightFaults, AnOverrideIsTakenAndGoesOnBeingSaid) {
  EXPECT_TRUE(setMode("rigid", /*override_preflight=*/true).success);
  EXPECT_TRUE(corrects(model_id_));
  EXPECT_TRUE(saysPreflight(CorrectionStatus::PREFLIGHT_OVERRIDDEN));
  EXPECT_TRUE(warns("the pre-flight of the model in use was overridden"));
  EXPECT_TRUE(enable(false).success);
  EXPECT_TRUE(enable(true).success) << "it holds until the next homing";
}

TEST_F(PreflightFaults, WithoutMotionCaptureOrMotionNothingIsJudged) {
  sees_ = false;
  const Preflight::Response blind = preflight(2.0);
  EXPECT_FALSE(blind.success || blind.passed);
  EXPECT_NE(blind.message.find("motion capture is silent"), std::string::npos) << blind.message;
  EXPECT_TRUE(std::isnan(blind.position_median_mm));
  sees_ = true;
  moves_ = false;
  const Preflight::Response still = preflight(2.0);
  EXPECT_FALSE(still.success || still.passed) << still.message;
  moves_ = true;
  EXPECT_TRUE(saysPreflight(CorrectionStatus::PREFLIGHT_NEEDED));
}

TEST_F(PreflightFaults, PosesInMillimetresDoNotPass) {
  metres_ = 1e3;
  const Preflight::Response judged = preflight(4.0);
  EXPECT_FALSE(judged.passed);
  ASSERT_FALSE(judged.findings.empty());
  EXPECT_NE(judged.findings[0].find("millimetres"), std::string::npos) << judged.findings[0];
  EXPECT_FALSE(enable(true).success);
}

TEST_F(PreflightFaults, GoodNumbersOfStreamsThatAreNotToBeTrustedDoNotPass) {
  repeats_ = true;
  const Preflight::Response judged = preflight();
  EXPECT_LT(judged.position_median_mm, judged.position_limit_mm) << judged.message;
  EXPECT_TRUE(judged.success);
  EXPECT_FALSE(judged.passed);
  EXPECT_NE(judged.message.find("not to be trusted"), std::string::npos) << judged.message;
  EXPECT_FALSE(enable(true).success);
}

TEST_F(PreflightFaults, OneRunsAtATimeAndSwitchingOffDoesNotWait) {
  ASSERT_TRUE(preflight().passed);
  ASSERT_TRUE(enable(true).success);
  ASSERT_TRUE(corrects(model_id_));
  sees_ = false;  // so that the first one goes on
  auto first = beginPreflight();
  EXPECT_TRUE(enable(false).success);
  EXPECT_TRUE(saysCode(CorrectionStatus::PASSED_OFF));
  EXPECT_FALSE(isReady(first));
  sees_ = true;  // it has soon seen enough
  EXPECT_TRUE(run([&] { return isReady(first); }));
}

TEST_F(PreflightFaults, OneInWhoseMidstTheRobotIsHomedDoesNotPass) {
  sees_ = false;  // so that it goes on
  auto running = beginPreflight();
  home();
  sees_ = true;
  ASSERT_TRUE(run([&] { return isReady(running); }));
  const Preflight::Response judged = running.get();
  EXPECT_FALSE(judged.success || judged.passed) << judged.message;
  EXPECT_NE(judged.message.find("homed meanwhile"), std::string::npos) << judged.message;
  EXPECT_LT(judged.position_median_mm, judged.position_limit_mm) << "else it would not pass anyway";
  EXPECT_TRUE(saysPreflight(CorrectionStatus::PREFLIGHT_NEEDED));
  EXPECT_FALSE(enable(true).success);
  EXPECT_TRUE(preflight().passed) << "once more";
}

TEST_F(PreflightFaults, AStreamThatIsMissingIsNamedWithWhatIsThere) {
  mocap_.shutdown();
  mocap_ = probe_.nh.advertise<geometry_msgs::PoseStamped>("tracker/measured_cp", 10);
  EXPECT_TRUE(warns("there is /arm/tracker/measured_cp"));
}

TEST_F(PreflightFaults, DesiredPosesInMillimetresAreNamed) {
  probe_.diagnostics.clear();
  EXPECT_TRUE(waitFor(
      [&] {
        Pose far = along(ros::Time::now().toSec() - start_);
        far.p *= 1e3;
        probe_.publisher.publish(probe_.message(far));
        ros::spinOnce();
        for (const auto& status : probe_.diagnostics)
          if (status.message.find("millimetres") != std::string::npos) return true;
        return false;
      },
      kPatience));
}

TEST(PreflightWithoutModel, NothingCanBeJudgedOrSwitchedOn) {
  CorrectorProbe<geometry_msgs::PoseStamped> probe("empty");
  std_srvs::SetBool enable;
  enable.request.data = true;
  ASSERT_TRUE(ros::service::call("/empty/corrector/enable", enable));
  EXPECT_FALSE(enable.response.success);
  EXPECT_NE(enable.response.message.find("no model"), std::string::npos);
  SetMode mode;
  mode.request.mode = "full";
  mode.request.override_preflight = true;
  ASSERT_TRUE(ros::service::call("/empty/corrector/set_mode", mode));
  EXPECT_FALSE(mode.response.success) << "there is nothing to take the responsibility for";
  Preflight preflight;
  ASSERT_TRUE(ros::service::call("/empty/corrector/preflight", preflight));
  EXPECT_FALSE(preflight.response.success);
  EXPECT_NE(preflight.response.message.find("no model"), std::string::npos);
}

}  // namespace
}  // namespace raven_correction

int main(int argc, char** argv) {
  return raven_correction::runNodeTests(argc, argv, "test_preflight");
}
