// SPDX-License-Identifier: BSD-3-Clause
// The simulator from outside: is it a robot and a motion-capture system to those who talk to it,
// with the rules of a real controller?
#include <diagnostic_msgs/DiagnosticArray.h>
#include <gtest/gtest.h>
#include <ros/ros.h>
#include <sensor_msgs/JointState.h>
#include <std_srvs/SetBool.h>
#include <std_srvs/Trigger.h>
#include <tf2_msgs/TFMessage.h>

#include <algorithm>
#include <fstream>
#include <map>
#include <vector>

#include "raven_correction/LoadModel.h"
#include "raven_correction/error.h"
#include "raven_correction/ros/conversions.h"
#include "raven_correction/ros/simulator_node.h"
#include "support/node_main.h"
#include "support/spin_until.h"
#include "support/temporary_directory.h"

namespace raven_correction {
namespace {

constexpr double kLimit = 20.0;  // for everything that takes milliseconds [s]

/// The last message of a topic, and how many there were.
template <typename Message>
class Listener {
 public:
  Listener(ros::NodeHandle& nh, const std::string& topic) {
    subscriber_ = nh.subscribe<Message>(topic, 1000, [this](const auto& message) {
      last = *message;
      stamps.push_back(message->header.stamp.toSec());
    });
  }
  Message last;
  std::vector<double> stamps;

 private:
  ros::Subscriber subscriber_;
};

double medianPeriodOf(const std::vector<double>& stamps) {
  std::vector<double> periods;
  for (std::size_t i = 1; i < stamps.size(); ++i)
    if (stamps[i] > stamps[i - 1]) periods.push_back(stamps[i] - stamps[i - 1]);
  std::nth_element(periods.begin(), periods.begin() + static_cast<long>(periods.size() / 2),
                   periods.end());
  return periods[periods.size() / 2];
}

class Simulator : public ::testing::Test {
 protected:
  Simulator()
      : nh("raven/left"),
        measured(nh, "measured_cp"),
        setpoint(nh, "setpoint_cp"),
        mocap(nh, "mocap/measured_cp"),
        joints(nh, "measured_js"),
        jaw(nh, "jaw/measured_js") {
    tf_ = nh.subscribe<tf2_msgs::TFMessage>("/tf_static", 10, [this](const auto& message) {
      for (const auto& transform : message->transforms)
        transforms[transform.child_frame_id] = transform;
    });
    diagnostics_ = nh.subscribe<diagnostic_msgs::DiagnosticArray>(
        "/diagnostics", 10, [this](const auto& message) {
          for (const auto& status : message->status)
            for (const auto& value : status.values) diagnostics[value.key] = value.value;
        });
    EXPECT_TRUE(until([this] {
      return measured.stamps.size() > 1 && setpoint.stamps.size() > 1 && mocap.stamps.size() > 1;
    }));
    std_srvs::Trigger reset;
    EXPECT_TRUE(ros::service::call(nh.resolveName("simulator/reset"), reset));
    EXPECT_TRUE(reset.response.success) << reset.response.message;
    // Its first command after a reset only wakes the controller.
    servo = nh.advertise<geometry_msgs::PoseStamped>("servo_cp", 1);
    EXPECT_TRUE(until([this] { return servo.getNumSubscribers() > 0; }));
    const long first = counted("commands first discarded");
    EXPECT_TRUE(until([&] {
      if (counted("commands first discarded") <= first) send(setpointPose());
      return counted("commands first discarded") > first;
    }));
  }

  template <typename Condition>
  bool until(Condition condition) {
    return spinUntil(condition, kLimit);
  }
  Pose setpointPose() const { return poseFromMsg(setpoint.last.pose); }
  void send(const Pose& pose, const std::string& frame = "0_link") {
    servo.publish(stampedPoseToMsg(ros::Time::now().toSec(), pose, frame));
  }
  long counted(const std::string& key) const {
    const auto found = diagnostics.find(key);
    return found == diagnostics.end() ? 0 : std::stol(found->second);
  }
  /// Sends a pose until the controller aims at it.
  bool moveTo(const Pose& target) {
    return until([&] {
      send(target);
      return (setpointPose().p - target.p).norm() < 1e-6;
    });
  }
  Pose observed() const {
    return poseFromMsg(transforms.at("mocap").transform) * poseFromMsg(mocap.last.pose);
  }

  ros::NodeHandle nh;
  Listener<geometry_msgs::PoseStamped> measured, setpoint, mocap;
  Listener<sensor_msgs::JointState> joints, jaw;
  std::map<std::string, geometry_msgs::TransformStamped> transforms;
  std::map<std::string, std::string> diagnostics;
  ros::Publisher servo;

 private:
  ros::Subscriber tf_, diagnostics_;
};

TEST_F(Simulator, ReportsAtItsRatesInItsFrames) {
  ASSERT_TRUE(until([this] { return mocap.stamps.size() > 150 && joints.stamps.size() > 100; }));
  // Stamps are those of the simulated clocks, so a busy machine does not matter.
  EXPECT_NEAR(medianPeriodOf(measured.stamps), 0.01, 1e-4);
  EXPECT_NEAR(medianPeriodOf(setpoint.stamps), 0.01, 1e-4);
  EXPECT_NEAR(medianPeriodOf(joints.stamps), 0.01, 1e-4);
  EXPECT_NEAR(medianPeriodOf(mocap.stamps), 1.0 / 120.0, 1e-4);
  EXPECT_EQ(measured.last.header.frame_id, "0_link");
  EXPECT_EQ(setpoint.last.header.frame_id, "0_link");
  EXPECT_EQ(mocap.last.header.frame_id, "mocap");
  EXPECT_EQ(joints.last.name.size(), 6u);
  EXPECT_EQ(joints.last.position.size(), joints.last.name.size());
  EXPECT_NEAR(medianPeriodOf(jaw.stamps), 0.01, 1e-4);
  EXPECT_EQ(jaw.last.name, std::vector<std::string>{"jaw"});
  EXPECT_EQ(jaw.last.position.size(), 1u);
}

TEST_F(Simulator, PublishesTheRegistrationThatItsMotionCaptureIsIn) {
  ASSERT_TRUE(until([this] { return transforms.count("mocap") > 0; }));
  const geometry_msgs::TransformStamped& transform = transforms.at("mocap");
  EXPECT_EQ(transform.header.frame_id, "0_link");
  EXPECT_NEAR(transform.transform.translation.x, 0.087, 1e-12);
  EXPECT_NEAR(transform.transform.translation.y, 1.778, 1e-12);
  EXPECT_NEAR(transform.transform.translation.z, -0.770, 1e-12);
  // The arm errs by centimetres; a registration the wrong way round would be metres off.
  EXPECT_LT((observed().p - poseFromMsg(measured.last.pose).p).norm(), 0.06);
  EXPECT_GT(poseFromMsg(mocap.last.pose).p.norm(), 1.0);
}

TEST_F(Simulator, ACommandMovesSetpointEncodersAndTool) {
  ASSERT_TRUE(until([this] { return transforms.count("mocap") > 0; }));
  const Pose start = setpointPose();
  const Eigen::Vector3d seen = observed().p;
  const Eigen::Vector3d step(0.0, 0.02, 0.0);
  Pose target = start;
  target.p += step;
  ASSERT_TRUE(moveTo(target));
  EXPECT_TRUE(until([&] {  // what friction leaves is millimetres
    return (poseFromMsg(measured.last.pose).p - target.p).norm() < 0.008 &&
           (observed().p - seen - step).norm() < 0.012;
  }));
}

TEST_F(Simulator, ResetBringsTheArmHome) {
  const Pose home = setpointPose();
  Pose target = home;
  target.p.z() += 0.01;
  ASSERT_TRUE(moveTo(target));
  std_srvs::Trigger reset;
  ASSERT_TRUE(ros::service::call(nh.resolveName("simulator/reset"), reset));
  EXPECT_TRUE(until([&] { return (setpointPose().p - home.p).norm() < 1e-9; }));
}

TEST_F(Simulator, DoesNotHoldAClockThatIsNotItsOwn) {
  std_srvs::SetBool pause;
  pause.request.data = true;
  ASSERT_TRUE(ros::service::call(nh.resolveName("simulator/pause"), pause));
  EXPECT_FALSE(pause.response.success);
  EXPECT_NE(pause.response.message.find("~clock_rate"), std::string::npos)
      << pause.response.message;
  const std::size_t before = measured.stamps.size();
  EXPECT_TRUE(until([&] { return measured.stamps.size() > before + 5; })) << "it goes on";
}

TEST_F(Simulator, DropsAWrongFrameAndSaysSo) {
  const Pose before = setpointPose();
  const long dropped = counted("commands wrong frame");
  Pose target = before;
  target.p.x() += 0.01;
  ASSERT_TRUE(until([&] {
    send(target, "");
    send(target, "mocap");
    return counted("commands wrong frame") > dropped;
  }));
  EXPECT_LT((setpointPose().p - before.p).norm(), 1e-9);
}

TEST_F(Simulator, DropsWhatIsNotAPoseAndWhatItCannotReach) {
  const Pose before = setpointPose();
  const long not_finite = counted("commands not finite");
  const long no_ik = counted("commands out of reach");
  Pose bad = before;
  bad.p.x() = std::numeric_limits<double>::quiet_NaN();
  ASSERT_TRUE(until([&] {
    send(bad);
    return counted("commands not finite") > not_finite;
  }));
  Pose far = before;
  far.p.x() += 5.0;
  ASSERT_TRUE(until([&] {
    send(far);
    return counted("commands out of reach") > no_ik;
  }));
  EXPECT_LT((setpointPose().p - before.p).norm(), 1e-9);
}

TEST_F(Simulator, TheReplayOfALatchedPublisherDoesNotMoveIt) {
  const Pose before = setpointPose();
  const long dropped = counted("commands latched");
  Pose old = before;
  old.p.x() += 0.01;
  servo.shutdown();
  servo = nh.advertise<geometry_msgs::PoseStamped>("servo_cp", 1, true);
  servo.publish(stampedPoseToMsg(ros::Time::now().toSec(), old, "0_link"));
  ASSERT_TRUE(until([&] { return counted("commands latched") > dropped; }));
  EXPECT_LT((setpointPose().p - before.p).norm(), 1e-9);
}

TEST_F(Simulator, TheJawOpensAndClosesOnWhatItHolds) {
  const Pose before = setpointPose();
  ros::Publisher command = nh.advertise<sensor_msgs::JointState>("jaw/servo_jp", 1);
  ASSERT_TRUE(until([&] { return command.getNumSubscribers() > 0; }));
  const auto opensTo = [&](double opening) {
    return until([&] {
      command.publish(
          jointsToMsg(ros::Time::now().toSec(), {"jaw"}, Eigen::VectorXd::Constant(1, opening)));
      return !jaw.last.position.empty() && jaw.last.position[0] == opening;
    });
  };
  ASSERT_TRUE(opensTo(0.8));
  EXPECT_TRUE(until([this] { return diagnostics["payload [g]"] == "0.000"; }));
  ASSERT_TRUE(opensTo(0.0));
  EXPECT_TRUE(until([this] { return diagnostics["payload [g]"] == "0.500"; }))
      << diagnostics["payload [g]"];
  ASSERT_TRUE(opensTo(0.8));
  EXPECT_TRUE(until([this] { return diagnostics["payload [g]"] == "0.000"; }));
  EXPECT_LT((setpointPose().p - before.p).norm(), 1e-9) << "the pose is not the jaw's business";

  const long refused = counted("jaw commands refused");
  ASSERT_TRUE(until([&] {
    command.publish(
        jointsToMsg(ros::Time::now().toSec(), {"jaw", "more"}, Eigen::Vector2d(0.0, 0.0)));
    command.publish(
        jointsToMsg(ros::Time::now().toSec(), {"jaw"}, Eigen::VectorXd::Constant(1, std::nan(""))));
    return counted("jaw commands refused") > refused + 1;
  }));
  EXPECT_EQ(jaw.last.position[0], 0.8);
}

TEST_F(Simulator, LoadsAnotherSimulationAndKeepsItsOwnWhereItCannot) {
  std::string directory;
  ASSERT_TRUE(ros::param::get("/configuration", directory));
  ASSERT_TRUE(until([this] { return transforms.count("mocap") > 0; }));
  LoadModel load;
  load.request.file = directory + "/no_such_file.yaml";
  ASSERT_TRUE(ros::service::call(nh.resolveName("simulator/load"), load));
  EXPECT_FALSE(load.response.success);
  EXPECT_NE(load.response.message.find("no_such_file.yaml"), std::string::npos);
  EXPECT_EQ(load.response.model, "demo");

  // A robot that is described in another frame than the one that is published.
  const TemporaryDirectory temporary;
  load.request.file = temporary.path() + "/gold.yaml";
  std::ofstream(load.request.file)
      << "name: gold\nrobot: " << directory << "/robots/raven2_gold.yaml\n";
  ASSERT_TRUE(ros::service::call(nh.resolveName("simulator/load"), load));
  EXPECT_FALSE(load.response.success);
  EXPECT_NE(load.response.message.find("raven2_gold_base"), std::string::npos)
      << load.response.message;
  EXPECT_EQ(load.response.model, "demo");

  load.request.file = directory + "/simulation/nominal.yaml";
  ASSERT_TRUE(ros::service::call(nh.resolveName("simulator/load"), load));
  EXPECT_TRUE(load.response.success) << load.response.message;
  EXPECT_TRUE(until([this] {  // an arm without errors is where its encoders say
    return (observed().p - poseFromMsg(measured.last.pose).p).norm() < 0.002;
  }));

  load.request.file = directory + "/simulation/raven2_left_case2014.yaml";
  ASSERT_TRUE(ros::service::call(nh.resolveName("simulator/load"), load));
  EXPECT_TRUE(load.response.success) << load.response.message;
}

TEST(SimulatorParams, TheShippedFileHoldsTheDefaults) {
  const SimulatorParams shipped = loadSimulatorParams(ros::NodeHandle("/shipped"));
  const SimulatorParams defaults;
  ASSERT_EQ(shipped.arms.size(), 1u);
  const SimulatedArmParams& arm = shipped.arms[0];
  const SimulatedArmParams default_arm;
  EXPECT_EQ(arm.name, "");
  EXPECT_EQ(arm.seed, default_arm.seed);
  EXPECT_EQ(arm.rates.measured_cp, default_arm.rates.measured_cp);
  EXPECT_EQ(arm.rates.setpoint_cp, default_arm.rates.setpoint_cp);
  EXPECT_EQ(arm.rates.measured_js, default_arm.rates.measured_js);
  EXPECT_EQ(arm.base_frame, default_arm.base_frame);
  EXPECT_EQ(arm.mocap_frame, default_arm.mocap_frame);
  EXPECT_EQ(arm.gate.discard_first, default_arm.gate.discard_first);
  EXPECT_EQ(arm.gate.max_step, default_arm.gate.max_step);
  EXPECT_EQ(arm.gate.reject_step, default_arm.gate.reject_step);
  EXPECT_EQ(arm.gate.stamp_tolerance, default_arm.gate.stamp_tolerance);
  EXPECT_EQ(shipped.loop_rate, defaults.loop_rate);
  EXPECT_EQ(shipped.clock_rate, defaults.clock_rate);
  EXPECT_EQ(shipped.clock_frequency, defaults.clock_frequency);
}

std::string refusal(const std::string& ns) {
  try {
    loadSimulatorParams(ros::NodeHandle(ns));
  } catch (const InvalidInput& error) {
    return error.what();
  }
  return "";
}

TEST(SimulatorParams, AllProblemsAreNamedAtOnce) {
  const std::string text = refusal("/bad");
  for (const char* part : {"~simulation", "~seed", "~measured_cp_rate", "did you mean clock_rate?"})
    EXPECT_NE(text.find(part), std::string::npos) << part << " is missing in\n" << text;
}

TEST(SimulatorParams, ArmsHaveWhatIsCommonAndWhatIsTheirOwn) {
  const SimulatorParams params = loadSimulatorParams(ros::NodeHandle("/two_arms"));
  ASSERT_EQ(params.arms.size(), 3u);
  const SimulatedArmParams& left = params.arms[0];
  const SimulatedArmParams& right = params.arms[1];
  EXPECT_EQ(left.name, "left");
  EXPECT_EQ(right.name, "right");
  EXPECT_NE(left.simulation, right.simulation);
  EXPECT_EQ(params.arms[2].simulation, left.simulation);
  EXPECT_EQ(left.seed, 7) << "the common one";
  EXPECT_EQ(right.seed, 8) << "the next";
  EXPECT_EQ(params.arms[2].seed, 70) << "its own";
  EXPECT_EQ(left.rates.measured_cp, 50.0);
  EXPECT_EQ(right.rates.measured_cp, 25.0);
  EXPECT_EQ(left.base_frame, "0_link");
  EXPECT_EQ(right.base_frame, "right_base");
  EXPECT_EQ(right.gate.base_frame, "right_base");
  EXPECT_EQ(right.X_base_mocap.p, Eigen::Vector3d(1.0, 2.0, 3.0));
}

TEST(SimulatorParams, AllProblemsOfAllArmsAreNamedAtOnce) {
  const std::string text = refusal("/bad_arms");
  for (const char* part :
       {"~arms", "\"a/b\" is not a letter", "\"left\" is there twice", "~left/simulation",
        "~left/seed", "did you mean right/seed?", "~right/mocap_frame", "as that of left"})
    EXPECT_NE(text.find(part), std::string::npos) << part << " is missing in\n" << text;
}

TEST(SimulatorParams, AClockThatNobodyListensToIsRefused) {
  EXPECT_NE(refusal("/no_sim_time").find("/use_sim_time"), std::string::npos);
}

}  // namespace
}  // namespace raven_correction

int main(int argc, char** argv) {
  return raven_correction::runNodeTests(argc, argv, "test_simulator");
}
