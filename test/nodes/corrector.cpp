// SPDX-License-Identifier: BSD-3-Clause
// Trainer and corrector as a user drives them: retrain from a bag by service, correct poses live,
// refuse bad ones, roll back.
#include <gtest/gtest.h>
#include <raven_correction/LoadModel.h>
#include <raven_correction/Retrain.h>
#include <raven_correction/SaveModel.h>
#include <raven_correction/TrainingReport.h>
#include <raven_correction/WorkProgress.h>
#include <ros/package.h>
#include <ros/ros.h>
#include <std_srvs/Trigger.h>

#include <filesystem>
#include <fstream>
#include <set>

#include "raven_correction/correction/predictor.h"
#include "raven_correction/ros/conversions.h"
#include "raven_correction/ros/model_file.h"
#include "raven_correction/ros/session_bag.h"
#include "raven_correction/simulation/session.h"
#include "support/corrector_probe.h"
#include "support/node_main.h"

namespace raven_correction {
namespace {

namespace fs = std::filesystem;

const Pose kDesired{{-0.02, -0.06, -0.14}, {0.5, -0.5, 0.5, 0.5}};

std::string directory() {
  std::string path;
  ros::param::get("directory", path);
  return path;
}

class NodesTest : public ::testing::Test {
 protected:
  using Probe = CorrectorProbe<geometry_msgs::PoseStamped>;

  void SetUp() override {
    model_ = probe_.nh.subscribe<CorrectionModel>("correction/model", 10,
                                                  [this](const auto& msg) { model_id_ = msg->id; });
    progress_ = probe_.nh.subscribe<WorkProgress>(
        "trainer/progress", 100, [this](const auto& msg) { phases_.insert(msg->phase); });
    report_ = probe_.nh.subscribe<TrainingReport>("trainer/report", 10,
                                                  [this](const auto& msg) { last_report_ = *msg; });
    ASSERT_TRUE(ros::service::waitForService("arm/trainer/retrain", 30000));
  }

  template <typename Service>
  Service call(const std::string& name, Service service) {
    EXPECT_TRUE(ros::service::call("/arm/" + name, service)) << name;
    return service;
  }

  geometry_msgs::PoseStamped desired() const { return probe_.message(kDesired); }
  void expectRefused(const geometry_msgs::PoseStamped& msg, std::uint8_t code) {
    probe_.expectRefused(msg, code, kDesired);
  }

  Probe probe_{"arm"};
  ros::Subscriber model_, progress_, report_;
  std::string model_id_;
  std::set<std::string> phases_;
  TrainingReport last_report_;
};

TEST_F(NodesTest, TheWholeJob) {
  // Before anything is learnt, poses pass unchanged, with the planner's stamp.
  const geometry_msgs::PoseStamped first = desired();
  EXPECT_EQ(probe_.send(first).code, CorrectionStatus::PASSED_OFF);
  ASSERT_TRUE(probe_.until([&] { return !probe_.commands.empty(); }));
  EXPECT_EQ(probe_.commands.back().pose, first.pose);
  EXPECT_EQ(probe_.commands.back().header.stamp, first.header.stamp);
  std_srvs::SetBool enable;
  enable.request.data = true;
  EXPECT_NE(call("corrector/enable", enable).response.message.find("no model"), std::string::npos);
  EXPECT_EQ(probe_.send(desired()).code, CorrectionStatus::PASSED_NO_MODEL);

  // A retraining without data, and one with a file that is not there, fail with the reason.
  Retrain retrain = call("trainer/retrain", Retrain());
  EXPECT_FALSE(retrain.response.success);
  EXPECT_NE(retrain.response.message.find("no bag"), std::string::npos) << retrain.response.message;
  retrain.request.bags = {"nowhere.bag"};
  retrain = call("trainer/retrain", retrain);
  EXPECT_FALSE(retrain.response.success);
  EXPECT_NE(retrain.response.message.find("nowhere.bag"), std::string::npos);

  // A session of the simulated robot.
  const std::string package = ros::package::getPath("raven_correction");
  fs::create_directories(directory() + "/data");
  const std::string bag = directory() + "/data/session.bag";
  const Dataset session =
      simulateSession(loadSimulationConfig(package + "/config/simulation/demo.yaml"), 25, 5);
  writeSessionBag(session, bag);
  std::ofstream(directory() + "/quick.yaml")
      << "process: {criterion: validation, length_scales: per_vector, grouping: shared,\n"
         "          max_hyper_points: 200, max_exact_points: 800, variance_points: 200,\n"
         "          backend: exact}\n";
  // Recordings that cannot be trusted are not learnt from, and the text says what is wrong.
  Dataset millimetres = session;
  for (Trajectory& trajectory : millimetres.trajectories)
    for (StampedPose& sample : trajectory.observations) sample.pose.p *= 1e3;
  writeSessionBag(millimetres, directory() + "/data/millimetres.bag");
  retrain.request.bags = {"millimetres.bag"};
  retrain = call("trainer/retrain", retrain);
  EXPECT_FALSE(retrain.response.success);
  EXPECT_NE(retrain.response.message.find("millimetres.bag: the recording is not to be trusted"),
            std::string::npos)
      << retrain.response.message;
  ASSERT_EQ(retrain.response.findings.size(), 1u);
  EXPECT_NE(retrain.response.findings[0].find("millimetres"), std::string::npos);
  EXPECT_TRUE(probe_.until([&] { return last_report_.findings == retrain.response.findings; }));

  retrain.request.bags = {"session.bag"};  // relative to the data directory
  retrain.request.configuration = directory() + "/quick.yaml";
  retrain = call("trainer/retrain", retrain);
  ASSERT_TRUE(retrain.response.success) << retrain.response.message;
  EXPECT_TRUE(retrain.response.findings.empty()) << retrain.response.findings[0];
  EXPECT_TRUE(retrain.response.live);
  EXPECT_LT(retrain.response.position_after_mm, 0.25 * retrain.response.position_before_mm);
  ASSERT_EQ(retrain.response.files.size(), 1u);
  EXPECT_TRUE(fs::exists(retrain.response.files[0]));
  const std::string model = retrain.response.model;
  EXPECT_TRUE(probe_.until([&] { return model_id_ == model && last_report_.model == model; }));
  EXPECT_TRUE(last_report_.success);
  EXPECT_GT(last_report_.held_out_pairs, 0u);
  for (const char* const phase : {"reading", "cleaning", "fitting", "validating", "saving"})
    EXPECT_TRUE(phases_.count(phase)) << phase;

  // Now poses are corrected where the tool was seen in training: after a few the limit on steps is
  // behind us, and the command is what the model file says.
  geometry_msgs::PoseStamped sent;
  CorrectionStatus status;
  EXPECT_TRUE(probe_.until([&] {
    sent = desired();
    status = probe_.send(sent);
    return status.code == CorrectionStatus::CORRECTED;
  }));
  EXPECT_EQ(status.model, model);
  const Predictor predictor(readModelFile(retrain.response.files[0]));
  Motion rest;  // the same pose for long: no velocity
  rest.pose = poseFromMsg(sent.pose);
  const auto workspace = predictor.makeWorkspace();
  const Pose expected = predictor.predict(rest, *workspace).command;
  const Pose command = poseFromMsg(status.command);
  EXPECT_LT((command.p - expected.p).norm(), 1e-6);
  EXPECT_LT(rotationAngle(command.q, expected.q), 1e-5);
  EXPECT_GT((command.p - rest.pose.p).norm(), 0.005);

  // Every fault is refused with its code, and not forwarded.
  geometry_msgs::PoseStamped bad = desired();
  bad.pose.position.x = std::nan("");
  expectRefused(bad, CorrectionStatus::REFUSED_NOT_FINITE);
  bad = desired();
  bad.pose.orientation.w = 2.0;
  expectRefused(bad, CorrectionStatus::REFUSED_NOT_UNIT);
  bad = desired();
  bad.header.frame_id = "elsewhere";
  expectRefused(bad, CorrectionStatus::REFUSED_FRAME);
  bad = desired();
  bad.header.stamp = ros::Time(0);
  expectRefused(bad, CorrectionStatus::REFUSED_ZERO_STAMP);
  bad = desired();
  bad.header.stamp -= ros::Duration(2.0);
  expectRefused(bad, CorrectionStatus::REFUSED_STALE);
  bad = desired();
  bad.header.stamp += ros::Duration(2.0);
  expectRefused(bad, CorrectionStatus::REFUSED_FUTURE);
  expectRefused(sent, sent.header.stamp + ros::Duration(0.5) < ros::Time::now()
                          ? CorrectionStatus::REFUSED_STALE
                          : CorrectionStatus::REFUSED_TIME_BACKWARDS);

  // A dry run tells how good a model would be, even one that is forced; nothing is written, and the
  // model in use stays.
  const auto written = [] {
    std::set<std::string> files;
    for (const auto& entry : fs::recursive_directory_iterator(directory()))
      files.insert(entry.path().string());
    return files;
  };
  const std::set<std::string> files = written();
  Retrain dry = retrain;
  dry.response = Retrain::Response();
  dry.request.dry_run = true;
  dry.request.force = true;
  dry.request.output = directory() + "/models/dry.bag";
  dry = call("trainer/retrain", dry);
  ASSERT_TRUE(dry.response.success) << dry.response.message;
  EXPECT_GT(dry.response.position_after_mm, 0.0);
  EXPECT_FALSE(dry.response.live);
  EXPECT_TRUE(dry.response.files.empty());
  EXPECT_NE(dry.response.message.find("nothing written"), std::string::npos);
  EXPECT_EQ(written(), files);
  EXPECT_EQ(model_id_, model);
  EXPECT_EQ(probe_.send(desired()).model, model);

  // A second model that is forced, and the way back.
  Retrain again = retrain;
  again.request.force = true;
  again.request.output = directory() + "/models/second.bag";
  again = call("trainer/retrain", again);
  ASSERT_TRUE(again.response.success) << again.response.message;
  EXPECT_TRUE(probe_.until([&] { return model_id_ == again.response.model; }));
  const std_srvs::Trigger back = call("trainer/rollback", std_srvs::Trigger());
  EXPECT_TRUE(back.response.success);
  EXPECT_TRUE(probe_.until([&] { return model_id_ == model; }));
  EXPECT_FALSE(call("trainer/rollback", std_srvs::Trigger()).response.success);

  // Save never replaces unasked; load takes what save wrote, and refuses what is no model.
  SaveModel save;
  save.request.file = directory() + "/models/saved.bag";
  EXPECT_TRUE(call("trainer/save", save).response.success);
  EXPECT_FALSE(call("trainer/save", save).response.success);
  LoadModel load;
  load.request.file = save.request.file;
  EXPECT_TRUE(call("trainer/load", load).response.success);
  load.request.file = bag;
  EXPECT_FALSE(call("trainer/load", load).response.success);
  EXPECT_TRUE(probe_.until([&] { return model_id_ == model; }));

  // Modes.
  SetMode mode;
  mode.request.mode = "sideways";
  EXPECT_FALSE(call("corrector/set_mode", mode).response.success);
  mode.request.mode = "rigid";
  EXPECT_EQ(call("corrector/set_mode", mode).response.previous, "full");
  EXPECT_TRUE(
      probe_.until([&] { return probe_.send(desired()).code == CorrectionStatus::RIGID_ONLY; }));
  mode.request.mode = "off";
  call("corrector/set_mode", mode);
  EXPECT_TRUE(
      probe_.until([&] { return probe_.send(desired()).code == CorrectionStatus::PASSED_OFF; }));
}

TEST_F(NodesTest, TheFirstMessageOfALatchedPublisherIsNoCommand) {
  probe_.publisher.shutdown();
  probe_.publisher = probe_.nh.advertise<geometry_msgs::PoseStamped>("desired/servo_cp", 10, true);
  ASSERT_TRUE(probe_.until([&] { return probe_.publisher.getNumSubscribers() == 1; }));
  EXPECT_EQ(probe_.send(desired()).code, CorrectionStatus::REFUSED_LATCHED);
  EXPECT_NE(probe_.send(desired()).code, CorrectionStatus::REFUSED_LATCHED);
}

}  // namespace
}  // namespace raven_correction

int main(int argc, char** argv) {
  return raven_correction::runNodeTests(argc, argv, "test_corrector");
}
