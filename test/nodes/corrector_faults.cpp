// SPDX-License-Identifier: BSD-3-Clause
// Every fault of doc/faults.md that comes through a topic or a service, injected there. Those of
// the robot itself are corrector_robot_faults.cpp, those of clocks corrector_clock.cpp, those of
// processes corrector_processes.py.
#include <dynamic_reconfigure/Reconfigure.h>
#include <geometry_msgs/PoseArray.h>
#include <geometry_msgs/PoseStamped.h>
#include <gtest/gtest.h>

#include <cmath>
#include <thread>

#include "support/corrector_probe.h"
#include "support/node_main.h"
#include "support/simple_model.h"

namespace raven_correction {
namespace {

// config/corrector.yaml
constexpr double kTranslationRate = 0.15, kRotationRate = 2.0, kMaxStepTime = 0.1;

const Pose kInside{{0.01, 0.01, -0.01}, expRotation({0.02, 0.0, 0.01})};

/// Slowly along a line inside the trained region.
Pose along(double t) {
  return {{0.02 * std::sin(t), 0.01, -0.01}, expRotation({0.02, 0.0, 0.05 * std::sin(t)})};
}

const Correction& model() {
  static const Correction fitted = simpleModel();
  return fitted;
}

/// The corrector as most will have it: PoseStamped, config/corrector.yaml, switched on.
class CorrectorFaults : public ::testing::Test {
 protected:
  using Probe = CorrectorProbe<geometry_msgs::PoseStamped>;

  void SetUp() override { correctAgain(); }

  void correctAgain() {
    probe_.setMode("full");
    probe_.publishModel(model());
    ASSERT_TRUE(probe_.sendUntil(kInside, [](const CorrectionStatus& status) {
      return status.code == CorrectionStatus::CORRECTED && status.model == "simple";
    }));
  }
  geometry_msgs::PoseStamped good() const { return probe_.message(kInside); }
  void expectRefused(const geometry_msgs::PoseStamped& bad, std::uint8_t code) {
    probe_.expectRefused(bad, code, kInside);
  }
  /// A model that the corrector must not take: the one before goes on, and diagnostics say why.
  void expectModelRefused(const CorrectionModel& bad, const std::string& reason) {
    probe_.publishModel(bad);
    EXPECT_TRUE(probe_.diagnosed([&](const auto& status) {
      return status.level == diagnostic_msgs::DiagnosticStatus::WARN &&
             status.message.find("a model was refused") != std::string::npos &&
             status.message.find(reason) != std::string::npos;
    })) << reason;
    const CorrectionStatus status = probe_.send(kInside);
    EXPECT_EQ(status.code, CorrectionStatus::CORRECTED);
    EXPECT_EQ(status.model, "simple");
  }

  Probe probe_{"plain"};
};

// --- the message ---------------------------------------------------------------------------------

TEST_F(CorrectorFaults, NaNIsNotForwarded) {
  for (int component = 0; component < 7; ++component) {
    geometry_msgs::PoseStamped bad = good();
    double* const values[] = {&bad.pose.position.x,    &bad.pose.position.y,
                              &bad.pose.position.z,    &bad.pose.orientation.x,
                              &bad.pose.orientation.y, &bad.pose.orientation.z,
                              &bad.pose.orientation.w};
    *values[component] = component % 2 == 0 ? std::nan("") : HUGE_VAL;
    expectRefused(bad, CorrectionStatus::REFUSED_NOT_FINITE);
  }
}

TEST_F(CorrectorFaults, NonUnitQuaternionIsNotForwarded) {
  geometry_msgs::PoseStamped bad = good();
  bad.pose.orientation.w = 2.0;
  expectRefused(bad, CorrectionStatus::REFUSED_NOT_UNIT);
  bad = good();
  bad.pose.orientation = geometry_msgs::Quaternion();  // all zero, as from a default message
  expectRefused(bad, CorrectionStatus::REFUSED_NOT_UNIT);
}

TEST_F(CorrectorFaults, ZeroStampIsNotForwarded) {
  geometry_msgs::PoseStamped bad = good();
  bad.header.stamp = ros::Time(0);
  expectRefused(bad, CorrectionStatus::REFUSED_ZERO_STAMP);
}

TEST_F(CorrectorFaults, StaleStampIsNotForwarded) {
  geometry_msgs::PoseStamped bad = good();
  bad.header.stamp -= ros::Duration(2.0);
  expectRefused(bad, CorrectionStatus::REFUSED_STALE);
}

TEST_F(CorrectorFaults, StampAheadOfTheClockIsNotForwarded) {
  geometry_msgs::PoseStamped bad = good();
  bad.header.stamp += ros::Duration(30.0);
  expectRefused(bad, CorrectionStatus::REFUSED_FUTURE);
}

TEST_F(CorrectorFaults, DuplicateIsNotForwarded) {
  const geometry_msgs::PoseStamped first = good();
  EXPECT_EQ(probe_.send(first).code, CorrectionStatus::CORRECTED);
  expectRefused(first, CorrectionStatus::REFUSED_TIME_BACKWARDS);
}

TEST_F(CorrectorFaults, StampThatRunsBackIsNotForwarded) {
  geometry_msgs::PoseStamped first = good();
  EXPECT_EQ(probe_.send(first).code, CorrectionStatus::CORRECTED);
  first.header.stamp -= ros::Duration(0.01);
  expectRefused(first, CorrectionStatus::REFUSED_TIME_BACKWARDS);
}

TEST_F(CorrectorFaults, UnknownFrameIsNotForwarded) {
  expectRefused(probe_.message(kInside, "elsewhere"), CorrectionStatus::REFUSED_FRAME);
  EXPECT_LT(probe_.send(probe_.message(kInside, "/0_link")).code, 16);  // the same frame
}

TEST_F(CorrectorFaults, EmptyFrameIsNotForwardedUnlessAllowed) {
  expectRefused(probe_.message(kInside, ""), CorrectionStatus::REFUSED_FRAME);
}

TEST_F(CorrectorFaults, FirstMessageOfALatchedPublisherIsNotForwarded) {
  // The second time it is a planner that comes back under the same name, with its last message.
  for (int i = 0; i < 2; ++i) {
    probe_.publisher.shutdown();
    ASSERT_TRUE(probe_.until([&] { return probe_.publisher.getNumSubscribers() == 0; }));
    probe_.publisher =
        probe_.nh.advertise<geometry_msgs::PoseStamped>("desired/servo_cp", 10, /*latch=*/true);
    ASSERT_TRUE(probe_.until([&] { return probe_.publisher.getNumSubscribers() == 1; }));
    const std::size_t before = probe_.commands.size();
    EXPECT_EQ(probe_.send(good()).code, CorrectionStatus::REFUSED_LATCHED) << i;
    EXPECT_EQ(probe_.commands.size(), before);
    EXPECT_LT(probe_.send(good()).code, 16);
  }
}

// --- the stream ----------------------------------------------------------------------------------

TEST_F(CorrectorFaults, BurstOf10KilohertzKeepsOrderAndStepLimit) {
  probe_.statuses.clear();
  probe_.commands.clear();
  const ros::SteadyTime start = ros::SteadyTime::now();
  ros::Time last;
  for (int i = 0; i < 10000; ++i) {
    const double t = 1e-4 * i;
    probe_.publisher.publish(probe_.message(along(t)));
    if (i % 10 != 0) continue;
    ros::spinOnce();
    ros::SteadyTime::sleepUntil(start + ros::WallDuration(t));
  }
  // What came too fast is skipped, the newest always gets through.
  const geometry_msgs::PoseStamped newest = probe_.message(along(1.0));
  probe_.publisher.publish(newest);
  EXPECT_TRUE(probe_.until([&] {
    return !probe_.commands.empty() && probe_.commands.back().header.stamp == newest.header.stamp;
  }));
  EXPECT_GT(probe_.commands.size(), 100u);
  for (std::size_t i = 1; i < probe_.commands.size(); ++i)
    EXPECT_GT(probe_.commands[i].header.stamp, probe_.commands[i - 1].header.stamp);
  expectStepsWithin(probe_.statuses, kTranslationRate, kRotationRate, kMaxStepTime);
}

TEST_F(CorrectorFaults, SilenceOfThePlannerIsSilence) {
  probe_.commands.clear();
  probe_.statuses.clear();
  // Three reports, one a second, of a planner that says nothing.
  for (int i = 0; i < 3; ++i)
    EXPECT_TRUE(probe_.diagnosed([](const auto& status) {
      return status.message.find("the planner is silent") != std::string::npos;
    }));
  EXPECT_TRUE(probe_.commands.empty());
  EXPECT_TRUE(probe_.statuses.empty());
}

TEST_F(CorrectorFaults, SecondPublisherOnTheOutputEndsCorrection) {
  {
    ros::Publisher second = probe_.nh.advertise<geometry_msgs::PoseStamped>("servo_cp", 1);
    EXPECT_TRUE(probe_.sendUntil(kInside, [](const CorrectionStatus& status) {
      return status.code == CorrectionStatus::PASSED_OTHER_PUBLISHER;
    }));
    EXPECT_TRUE(probe_.diagnosed([](const auto& status) {
      return status.level == diagnostic_msgs::DiagnosticStatus::ERROR;
    }));
    EXPECT_EQ(probe_.statuses.back().command, probe_.statuses.back().desired);
  }
  EXPECT_TRUE(probe_.sendUntil(kInside, [](const CorrectionStatus& status) {
    return status.code == CorrectionStatus::CORRECTED;
  }));
  expectStepsWithin(probe_.statuses, kTranslationRate, kRotationRate, kMaxStepTime);
}

// --- models and modes ----------------------------------------------------------------------------

TEST_F(CorrectorFaults, ModelsAndModesSwappedUnderLoadNeverStepOverTheLimit) {
  Correction other = model();
  other.id = "other";
  other.rigid.p.x() -= 0.03;
  other.rigid.q = (other.rigid.q * expRotation({0.0, 0.3, 0.0})).normalized();
  const CorrectionModel first = modelToMsg(model()), second = modelToMsg(other);
  probe_.statuses.clear();
  const char* const modes[] = {"rigid", "off", "full", "endpoint", "full"};
  const ros::SteadyTime start = ros::SteadyTime::now();
  for (int i = 0; i < 1500; ++i) {
    if (i % 100 == 0) probe_.publishModel(i % 200 == 0 ? second : first);
    if (i % 250 == 125) probe_.setMode(modes[i / 250 % 5]);
    probe_.publisher.publish(probe_.message(along(2e-3 * i)));
    ros::spinOnce();
    ros::SteadyTime::sleepUntil(start + ros::WallDuration(2e-3 * i));
  }
  ASSERT_TRUE(probe_.until([&] { return probe_.statuses.size() > 300; }));
  std::set<std::string> used;
  for (const CorrectionStatus& status : probe_.statuses) used.insert(status.model);
  EXPECT_TRUE(used.count("simple") && used.count("other"));
  expectStepsWithin(probe_.statuses, kTranslationRate, kRotationRate, kMaxStepTime);
}

TEST_F(CorrectorFaults, CorruptModelIsRefused) {
  CorrectionModel bad = modelToMsg(model());
  bad.groups[0].z.pop_back();
  expectModelRefused(bad, "z has");
  bad = modelToMsg(model());
  bad.groups[0].alpha[3] = std::nan("");
  expectModelRefused(bad, "finite");
  bad = modelToMsg(model());
  bad.rigid.position.x = HUGE_VAL;
  expectModelRefused(bad, "rigid");
  bad = modelToMsg(model());
  bad.groups[0].kernel = "no such kernel";
  expectModelRefused(bad, "no such kernel");
}

TEST_F(CorrectorFaults, ModelOfAnotherVersionIsRefused) {
  CorrectionModel bad = modelToMsg(model());
  bad.format = CorrectionModel::FORMAT + 1;
  expectModelRefused(bad, "format");
}

TEST_F(CorrectorFaults, ModelOfAnotherFrameIsRefused) {
  CorrectionModel bad = modelToMsg(model());
  bad.header.frame_id = "1_link";
  expectModelRefused(bad, "1_link");
}

TEST_F(CorrectorFaults, ModelInOtherUnitsIsRefused) {
  CorrectionModel bad = modelToMsg(model());
  bad.units = "um deg";
  expectModelRefused(bad, "um deg");
}

TEST_F(CorrectorFaults, ModelOfAnotherMessageTypeIsRefused) {
  CorrectionModel bad = modelToMsg(model());
  bad.pose_type = "RavenCommand";
  expectModelRefused(bad, "RavenCommand");
}

TEST_F(CorrectorFaults, ExpiredModelIsRefused) {
  CorrectionModel bad = modelToMsg(model());
  bad.expires = ros::Time(2000.0);
  expectModelRefused(bad, "expired");
}

TEST_F(CorrectorFaults, ModelThatExpiresInUseGoesOnAndIsReported) {
  Correction mortal = model();
  mortal.id = "mortal";
  mortal.expires_at = ros::WallTime::now().toSec() + 2.0;
  probe_.publishModel(mortal);
  EXPECT_TRUE(probe_.sendUntil(
      kInside, [](const CorrectionStatus& status) { return status.model == "mortal"; }));
  EXPECT_TRUE(probe_.diagnosed([](const auto& status) {
    return status.level == diagnostic_msgs::DiagnosticStatus::WARN &&
           status.message.find("the model has expired") != std::string::npos;
  }));
  EXPECT_TRUE(probe_.sendUntil(kInside, [](const CorrectionStatus& status) {
    return status.code == CorrectionStatus::CORRECTED && status.model == "mortal";
  }));
}

TEST_F(CorrectorFaults, ModelThatAnswersWithNoNumberIsPassedAndReported) {
  CorrectionModel bad = modelToMsg(model());
  bad.id = "overflowing";
  for (double& weight : bad.groups[0].alpha) weight = 1.7e308;  // finite, but no sum of them
  probe_.statuses.clear();
  probe_.publishModel(bad);
  EXPECT_TRUE(probe_.sendUntil(kInside, [](const CorrectionStatus& status) {
    return status.code == CorrectionStatus::PASSED_MODEL_FAULT && status.command == status.desired;
  }));
  probe_.diagnostics.clear();
  EXPECT_TRUE(probe_.until([&] {
    probe_.send(kInside);
    for (const auto& said : probe_.diagnostics)
      if (said.level == diagnostic_msgs::DiagnosticStatus::ERROR &&
          said.message.find("not finite") != std::string::npos)
        return true;
    return false;
  }));
  expectStepsWithin(probe_.statuses, kTranslationRate, kRotationRate, kMaxStepTime);
}

TEST_F(CorrectorFaults, EndpointModeCorrectsTheEndsOfThePathAlone) {
  const Pose first = along(0.1), between = along(0.4), last = along(0.7);
  ros::Publisher path = probe_.nh.advertise<geometry_msgs::PoseArray>("desired/path", 1);
  ASSERT_TRUE(probe_.until([&] { return path.getNumSubscribers() == 1; }));
  geometry_msgs::PoseArray poses;
  poses.header.frame_id = "0_link";
  for (const Pose& pose : {first, between, last}) poses.poses.push_back(poseToMsg(pose));
  probe_.setMode("endpoint");
  const auto isPassed = [](const CorrectionStatus& status) {
    return status.code == CorrectionStatus::PASSED_BETWEEN_ENDPOINTS &&
           status.command == status.desired;
  };
  const auto isCorrected = [](const CorrectionStatus& status) {
    return status.code == CorrectionStatus::CORRECTED && status.mode == "endpoint";
  };
  EXPECT_TRUE(probe_.sendUntil(first, isPassed)) << "there is no path yet";
  path.publish(poses);
  EXPECT_TRUE(probe_.sendUntil(first, isCorrected));
  EXPECT_TRUE(probe_.sendUntil(between, isPassed));
  EXPECT_TRUE(probe_.sendUntil(last, isCorrected));
  // In a frame that is not known, a path is none.
  poses.header.frame_id = "elsewhere";
  path.publish(poses);
  EXPECT_TRUE(probe_.sendUntil(last, isPassed));
}

TEST_F(CorrectorFaults, AnnouncedPathIsUsedOnlyWhereThePosesAreOnIt) {
  ros::Publisher path = probe_.nh.advertise<geometry_msgs::PoseArray>("desired/path", 1);
  ASSERT_TRUE(probe_.until([&] { return path.getNumSubscribers() == 1; }));
  // Streams a motion and says whether any of its poses was corrected for the one ahead.
  const auto motion = [](int i) { return along(0.002 * i); };
  const auto ahead = [&](const std::string& frame, int first) {
    geometry_msgs::PoseArray poses;
    poses.header.frame_id = frame;
    for (int i = 0; i < 5000; ++i) poses.poses.push_back(poseToMsg(motion(first + i)));
    path.publish(poses);
    probe_.diagnostics.clear();
    bool used = false, told = false;
    int i = 0;
    EXPECT_TRUE(probe_.until([&] {
      probe_.send(motion(i++));
      if (i < 200) probe_.diagnostics.clear();
      for (const auto& said : probe_.diagnostics)
        for (const auto& value : said.values)
          if (value.key == "share corrected for the announced pose ahead") {
            told = true;
            used |= value.value != "0.000";
          }
      return told;
    }));
    return used;
  };
  // A path and the poses come by connections of their own: too many poses may be before it.
  const auto once = [&] {
    for (int attempt = 0; attempt < 5; ++attempt)
      if (ahead("0_link", 0)) return true;
    return false;
  };
  EXPECT_TRUE(once());
  EXPECT_FALSE(ahead("elsewhere", 0));  // in a frame that is not known, a path is none
  EXPECT_FALSE(ahead("0_link", 1000));  // another motion than the one that comes
  EXPECT_TRUE(once());
  expectStepsWithin(probe_.statuses, kTranslationRate, kRotationRate, kMaxStepTime);
}

TEST_F(CorrectorFaults, WrongModeIsRefused) {
  SetMode call;
  call.request.mode = "sideways";
  ASSERT_TRUE(ros::service::call("plain/corrector/set_mode", call));
  EXPECT_FALSE(call.response.success);
  EXPECT_EQ(call.response.previous, "full");
  EXPECT_EQ(probe_.send(kInside).code, CorrectionStatus::CORRECTED);
}

TEST_F(CorrectorFaults, GainAndLimitsChangeLiveWithinTheStepLimit) {
  const auto set = [](const std::string& name, double value) {
    dynamic_reconfigure::Reconfigure call;
    call.request.config.doubles.resize(1);
    call.request.config.doubles[0].name = name;
    call.request.config.doubles[0].value = value;
    ASSERT_TRUE(ros::service::call("plain/corrector/set_parameters", call));
  };
  const auto length = [](const CorrectionStatus& status) {
    return (poseFromMsg(status.command).p - poseFromMsg(status.desired).p).norm();
  };
  probe_.statuses.clear();
  const double full = length(probe_.send(kInside));
  ASSERT_GT(full, 0.01);
  set("gain", 0.5);
  EXPECT_TRUE(probe_.sendUntil(kInside, [&](const CorrectionStatus& status) {
    return std::abs(length(status) - 0.5 * full) < 1e-4 && status.gain == 0.5;
  }));
  set("gain", 0.0);
  EXPECT_TRUE(probe_.sendUntil(
      kInside, [&](const CorrectionStatus& status) { return status.command == status.desired; }));
  set("gain", 1.0);
  set("max_translation", 0.004);
  EXPECT_TRUE(probe_.sendUntil(kInside, [&](const CorrectionStatus& status) {
    return std::abs(length(status) - 0.004) < 1e-9 &&
           status.code == CorrectionStatus::CORRECTED_LIMITED &&
           status.limits == CorrectionStatus::LIMIT_SIZE;
  }));
  set("max_translation", 0.06);
  EXPECT_TRUE(probe_.sendUntil(kInside, [](const CorrectionStatus& status) {
    return status.code == CorrectionStatus::CORRECTED;
  }));
  // What is no number changes nothing, and does not stay: the next change is taken.
  for (const char* const name : {"gain", "max_translation", "max_rotation"}) {
    set(name, std::nan(""));
    EXPECT_EQ(probe_.send(kInside).code, CorrectionStatus::CORRECTED);
    EXPECT_EQ(probe_.statuses.back().gain, 1.0);
    set("gain", 0.5);
    EXPECT_TRUE(probe_.sendUntil(
        kInside, [](const CorrectionStatus& status) { return status.gain == 0.5; }));
    set("gain", 1.0);
    EXPECT_TRUE(probe_.sendUntil(kInside, [](const CorrectionStatus& status) {
      return status.code == CorrectionStatus::CORRECTED && status.gain == 1.0;
    }));
  }
  expectStepsWithin(probe_.statuses, kTranslationRate, kRotationRate, kMaxStepTime);
}

TEST_F(CorrectorFaults, DiagnosticsSayRateLatencyAndModel) {
  EXPECT_TRUE(probe_.until([&] {
    probe_.send(kInside);
    for (const auto& status : probe_.diagnostics) {
      std::map<std::string, std::string> values;
      for (const auto& value : status.values) values[value.key] = value.value;
      if (values["model"] == "simple" && std::atof(values["input rate [1/s]"].c_str()) > 1.0 &&
          values["latency p50, p99, p99.9, max [us]"].size() > 10 &&
          std::atof(values["model age [h]"].c_str()) > 1.0 && values.count("share limited") &&
          values["furthest from the trained region [m]"] == "0.0000")
        return true;
    }
    return false;
  }));
  const Pose far{{0.08, 0.01, -0.01}, kInside.q};  // 3 cm outside of the box
  probe_.send(far);
  EXPECT_TRUE(probe_.diagnosed([](const auto& status) {
    for (const auto& value : status.values)
      if (value.key == "furthest from the trained region [m]") return value.value == "0.0300";
    return false;
  }));
}

// --- a corrector that knows which arm and tool it serves -----------------------------------------

TEST(PickyCorrectorFaults, ModelOfAnotherArmOrToolIsRefused) {
  CorrectorProbe<geometry_msgs::PoseStamped> probe("picky");
  const auto refused = [&](const std::string& reason) {
    return probe.diagnosed([&](const auto& status) {
      return status.message.find("a model was refused") != std::string::npos &&
             status.message.find(reason) != std::string::npos;
    });
  };
  Correction mine = model();
  probe.publishModel(mine);
  EXPECT_TRUE(refused("does not say for which arm"));
  mine.arm = "raven2_right";
  mine.tool = "grasper_8mm";
  probe.publishModel(mine);
  EXPECT_TRUE(refused("raven2_right"));
  mine.arm = "raven2_left";
  mine.tool = "needle_driver";
  probe.publishModel(mine);
  EXPECT_TRUE(refused("needle_driver"));
  mine.tool.clear();
  probe.publishModel(mine);
  EXPECT_TRUE(refused("does not say for which tool"));
  EXPECT_EQ(probe.send(kInside).code, CorrectionStatus::PASSED_NO_MODEL);
  mine.tool = "grasper_8mm";
  probe.publishModel(mine);
  EXPECT_TRUE(probe.sendUntil(kInside, [](const CorrectionStatus& status) {
    return status.code == CorrectionStatus::CORRECTED;
  }));
}

}  // namespace
}  // namespace raven_correction

int main(int argc, char** argv) {
  return raven_correction::runNodeTests(argc, argv, "test_corrector_faults");
}
