// SPDX-License-Identifier: BSD-3-Clause
// Faults of doc/faults.md that reach a trainer through its services: calls at the same time, a
// cancelled one, bags that nothing can be learnt from, data that would make the model worse. What a
// good call does is corrector.cpp.
#include <geometry_msgs/TransformStamped.h>
#include <gtest/gtest.h>
#include <raven_correction/LoadModel.h>
#include <raven_correction/Retrain.h>
#include <raven_correction/TrainingReport.h>
#include <raven_correction/WorkProgress.h>
#include <ros/package.h>
#include <ros/ros.h>
#include <rosbag/bag.h>
#include <std_msgs/String.h>
#include <std_srvs/Trigger.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <future>
#include <map>
#include <set>

#include "raven_correction/evaluation/validated_training.h"
#include "raven_correction/ros/conversions.h"
#include "raven_correction/ros/model_file.h"
#include "raven_correction/ros/session_bag.h"
#include "raven_correction/simulation/session.h"
#include "support/node_main.h"
#include "support/wait_for.h"

namespace raven_correction {
namespace {

namespace fs = std::filesystem;

constexpr double kLimit = 60.0;  // for what takes seconds on an idle machine [s]

std::string directory() {
  static const std::string path = [] {
    std::string read;
    ros::param::get("/directory", read);
    fs::create_directories(read + "/data");
    fs::create_directories(read + "/models");
    return read;
  }();
  return path;
}

std::string packageFile(const std::string& name) {
  return ros::package::getPath("raven_correction") + "/" + name;
}

/// A session of the simulated robot, made once.
const Dataset& session() {
  static const Dataset simulated =
      simulateSession(loadSimulationConfig(packageFile("config/simulation/demo.yaml")), 25, 5);
  return simulated;
}

std::string goodBag() {
  const std::string bag = directory() + "/data/good.bag";
  if (!fs::exists(bag)) writeSessionBag(session(), bag);
  return bag;
}

/// Four of the same motions; what was seen of those that are learnt from is off by three
/// centimetres.
std::string badBag() {
  const std::string bag = directory() + "/data/bad.bag";
  if (fs::exists(bag)) return bag;
  Dataset wrong = session();
  wrong.trajectories.resize(4);
  for (Trajectory& trajectory : wrong.trajectories)
    if (!isHeldOut(trajectory))
      for (StampedPose& seen : trajectory.observations) seen.pose.p.x() += 0.03;
  writeSessionBag(wrong, bag);
  return bag;
}

class TrainerFaults : public ::testing::Test {
 protected:
  void SetUp() override {
    model_ = nh_.subscribe<CorrectionModel>("correction/model", 10, [this](const auto& msg) {
      const std::lock_guard<std::mutex> lock(mutex_);
      live_ = msg->id;
    });
    progress_ = nh_.subscribe<WorkProgress>("trainer/progress", 1000, [this](const auto& msg) {
      const std::lock_guard<std::mutex> lock(mutex_);
      told_.push_back(*msg);
    });
    spinner_.start();
    ASSERT_TRUE(ros::service::waitForService("arm/trainer/retrain", 30000));
    ASSERT_TRUE(waitFor([&] { return !told().empty(); }, kLimit));
    if (!fs::exists(directory() + "/models/first.bag")) {
      const Retrain::Response first = retrain({goodBag()}, "first.bag");
      ASSERT_TRUE(first.success) << first.message;
      ASSERT_TRUE(first.live) << first.message;
    }
    const std::string id = readModelFile(directory() + "/models/first.bag").id;
    load("first.bag");
    ASSERT_TRUE(waitFor([&] { return live() == id; }, kLimit));
    first_ = id;
    files_ = files();
  }
  void TearDown() override { spinner_.stop(); }

  static Retrain::Response retrain(const std::vector<std::string>& bags, const std::string& output,
                                   const std::string& configuration = "") {
    Retrain::Request request;
    Retrain::Response response;
    request.bags = bags;
    if (!output.empty()) request.output = directory() + "/models/" + output;
    request.configuration = configuration;
    EXPECT_TRUE(ros::service::call("/arm/trainer/retrain", request, response));
    return response;
  }
  static void load(const std::string& file) {
    LoadModel call;
    call.request.file = directory() + "/models/" + file;
    EXPECT_TRUE(ros::service::call("/arm/trainer/load", call));
    EXPECT_TRUE(call.response.success) << call.response.message;
  }
  static std_srvs::Trigger::Response trigger(const std::string& name) {
    std_srvs::Trigger call;
    EXPECT_TRUE(ros::service::call("/arm/trainer/" + name, call));
    return call.response;
  }
  /// A configuration with which a training takes minutes, so that there is time to disturb it.
  static std::string slow() {
    const std::string file = directory() + "/slow.yaml";
    std::ofstream(file)
        << "process: {criterion: likelihood, length_scales: per_feature, grouping: own,\n"
           "          max_hyper_points: 3000, max_exact_points: 3000, backend: exact,\n"
           "          restarts: 20}\n";
    return file;
  }
  static std::set<std::string> files() {
    std::set<std::string> all;
    for (const auto& entry : fs::recursive_directory_iterator(directory() + "/models"))
      all.insert(entry.path().string());
    return all;
  }
  std::string live() {
    const std::lock_guard<std::mutex> lock(mutex_);
    return live_;
  }
  std::vector<WorkProgress> told() {
    const std::lock_guard<std::mutex> lock(mutex_);
    return told_;
  }
  bool isIn(const std::string& phase) {
    const auto all = told();
    return all.back().state == WorkProgress::RUNNING && all.back().phase == phase;
  }
  void expectNothingChanged() {
    EXPECT_EQ(files(), files_);
    // The topic is latched: whoever asks now gets what is live.
    const auto now =
        ros::topic::waitForMessage<CorrectionModel>("/arm/correction/model", ros::Duration(kLimit));
    ASSERT_NE(now, nullptr);
    EXPECT_EQ(now->id, first_);
  }
  void expectRefused(const std::string& bag, const std::vector<std::string>& reasons) {
    const Retrain::Response response = retrain({bag}, "");
    EXPECT_FALSE(response.success);
    EXPECT_FALSE(response.live);
    for (const std::string& reason : reasons)
      EXPECT_NE(response.message.find(reason), std::string::npos) << response.message;
    EXPECT_NE(response.message.find(bag), std::string::npos) << response.message;
    // The one before may have been refused, too.
    EXPECT_TRUE(waitFor(
        [&] {
          const WorkProgress last = told().back();
          return last.state == WorkProgress::FAILED && last.message == response.message;
        },
        kLimit))
        << told().back().message;
    expectNothingChanged();
  }

  ros::NodeHandle nh_{"arm"};
  std::string first_;            // id of the model in use when a test begins
  std::set<std::string> files_;  // in the model directory, then

 private:
  std::mutex mutex_;  // guards what follows
  std::string live_;
  std::vector<WorkProgress> told_;

  ros::Subscriber model_, progress_;
  ros::AsyncSpinner spinner_{2};
};

// --- calls ---------------------------------------------------------------------------------------

TEST_F(TrainerFaults, SecondCallIsRefusedWhileOneRunsWhichCanBeCancelled) {
  auto first = std::async(std::launch::async, [] { return retrain({goodBag()}, "", slow()); });
  ASSERT_TRUE(waitFor([&] { return isIn("fitting"); }, kLimit));
  const Retrain::Response second = retrain({goodBag()}, "second.bag");
  EXPECT_FALSE(second.success);
  EXPECT_NE(second.message.find("a training is running"), std::string::npos) << second.message;
  EXPECT_TRUE(isIn("fitting"));  // the first one was not disturbed

  // It ends at its next step, long before it would have, and leaves all as it was.
  const std_srvs::Trigger::Response cancelled = trigger("cancel");
  EXPECT_TRUE(cancelled.success) << cancelled.message;
  ASSERT_EQ(first.wait_for(std::chrono::seconds(30)), std::future_status::ready);
  const Retrain::Response ended = first.get();
  EXPECT_FALSE(ended.success);
  EXPECT_FALSE(ended.live);
  EXPECT_EQ(ended.message, "cancelled; nothing was changed");
  EXPECT_TRUE(waitFor([&] { return told().back().state == WorkProgress::FAILED; }, kLimit));
  EXPECT_EQ(told().back().message, ended.message);
  expectNothingChanged();
  EXPECT_FALSE(trigger("cancel").success);  // there is nothing to cancel any more

  // And the next one is as if there had been none.
  const Retrain::Response next = retrain({goodBag()}, "");
  EXPECT_TRUE(next.success) << next.message;
  for (const std::string& file : next.files) fs::remove(file);
}

TEST_F(TrainerFaults, ModelThatCameIntoUseMeanwhileIsNotReplacedUnseen) {
  Retrain::Request forced;  // worse than the first, so that the training would win over it
  Retrain::Response worse;
  forced.bags = {badBag()};
  forced.force = true;
  forced.output = directory() + "/models/worse.bag";
  fs::remove(forced.output);
  ASSERT_TRUE(ros::service::call("/arm/trainer/retrain", forced, worse));
  ASSERT_TRUE(worse.live) << worse.message;
  const std::size_t before = told().size();
  auto training = std::async(std::launch::async, [] {
    return retrain({goodBag()}, "", packageFile("config/trainer.yaml"));
  });
  ASSERT_TRUE(waitFor(
      [&] {
        const auto all = told();
        return std::any_of(all.begin() + static_cast<std::ptrdiff_t>(before), all.end(),
                           [](const WorkProgress& p) { return p.phase == "fitting"; });
      },
      kLimit));
  EXPECT_TRUE(trigger("rollback").success);
  const Retrain::Response response = training.get();
  EXPECT_TRUE(response.success) << response.message;
  EXPECT_FALSE(response.live);
  EXPECT_NE(response.message.find("meanwhile"), std::string::npos) << response.message;
  EXPECT_EQ(response.files.size(), 1u);  // it is there for ~load
  for (const std::string& file : response.files) fs::remove(file);
  fs::remove(forced.output);
  expectNothingChanged();
}

TEST_F(TrainerFaults, ProgressIsToldAllTheWay) {
  const std::size_t before = told().size();
  const Retrain::Response response = retrain({goodBag()}, "", packageFile("config/trainer.yaml"));
  ASSERT_TRUE(response.success) << response.message;
  ASSERT_TRUE(waitFor([&] { return told().back().state == WorkProgress::SUCCEEDED; }, kLimit));
  std::vector<std::string> phases;
  std::map<std::string, int> times;
  double fraction = 0.0;
  const auto all = told();
  for (std::size_t i = before; i + 1 < all.size(); ++i) {
    EXPECT_EQ(all[i].state, WorkProgress::RUNNING);
    EXPECT_GE(all[i].fraction, fraction) << all[i].phase;
    EXPECT_LE(all[i].fraction, 1.0);
    fraction = all[i].fraction;
    ++times[all[i].phase];
    if (phases.empty() || phases.back() != all[i].phase) phases.push_back(all[i].phase);
  }
  EXPECT_EQ(phases, (std::vector<std::string>{"reading", "synchronising", "cleaning", "fitting",
                                              "validating", "saving"}));
  EXPECT_GE(times["fitting"], 5);  // which takes most of the time
  EXPECT_EQ(all.back().fraction, 1.0);
  for (const std::string& file : response.files) fs::remove(file);
}

// --- bags ----------------------------------------------------------------------------------------

TEST_F(TrainerFaults, DamagedBagIsRefused) {
  std::ifstream good(goodBag(), std::ios::binary);
  const std::string bytes((std::istreambuf_iterator<char>(good)), std::istreambuf_iterator<char>());
  const std::string bag = directory() + "/damaged.bag";
  const auto write = [&](const std::string& content) {
    std::ofstream(bag, std::ios::binary) << content;
  };
  write(bytes.substr(0, bytes.size() / 2));  // the recorder was killed, or the copy was
  expectRefused(bag, {"not a complete bag", "rosbag reindex"});
  write("");
  expectRefused(bag, {"not a complete bag"});
  write("a text and no bag\n");
  expectRefused(bag, {"not a complete bag"});
  std::string noise(50000, ' ');
  std::mt19937_64 random(3);
  for (char& byte : noise) byte = static_cast<char>(random());
  write(noise);
  expectRefused(bag, {"not a complete bag"});
  write(bytes.substr(0, 8192) + noise + bytes.substr(8192 + noise.size()));  // a hole in a chunk
  expectRefused(bag, {"not a complete bag"});
}

TEST_F(TrainerFaults, ForeignBagIsRefused) {
  const std::string bag = directory() + "/foreign.bag";
  {
    rosbag::Bag file(bag, rosbag::bagmode::Write);
    std_msgs::String text;
    text.data = "hello";
    file.write("/chatter", ros::Time(10.0), text);
  }
  expectRefused(bag, {"no message on servo_cp", "rosbag info"});
  // A model file is a bag, too.
  const Retrain::Response response = retrain({directory() + "/models/first.bag"}, "");
  EXPECT_FALSE(response.success);
  EXPECT_NE(response.message.find("no message on servo_cp"), std::string::npos);
}

/// Good messages, but on one topic.
template <typename Message>
std::string bagWith(const std::string& name, const std::string& topic, const Message& other) {
  const std::string bag = directory() + "/" + name;
  rosbag::Bag file(bag, rosbag::bagmode::Write);
  const auto write = [&](const std::string& to, double t) {
    if (to == topic)
      file.write(to, ros::Time(10.0 + t), other);
    else
      file.write(to, ros::Time(10.0 + t),
                 stampedPoseToMsg(10.0 + t, {{0.1, 0.1 * t, 0.0}, expRotation({0.1, 0.0, 0.0})},
                                  "0_link"));
  };
  for (int i = 0; i < 100; ++i) {
    write("servo_cp", 0.01 * i);
    write("mocap/measured_cp", 0.01 * i);
  }
  if (topic == "trajectory_event") file.write(topic, ros::Time(10.0), other);
  return bag;
}

TEST_F(TrainerFaults, BagWithOtherMessageTypesIsRefusedAndSaysWhichItHolds) {
  expectRefused(bagWith("commands.bag", "servo_cp", geometry_msgs::TransformStamped()),
                {"servo_cp holds geometry_msgs/TransformStamped", "geometry_msgs/PoseStamped"});
  expectRefused(bagWith("seen.bag", "mocap/measured_cp", geometry_msgs::Pose()),
                {"mocap/measured_cp holds geometry_msgs/Pose,"});
  expectRefused(bagWith("events.bag", "trajectory_event", std_msgs::String()),
                {"trajectory_event holds std_msgs/String", "raven_correction/TrajectoryEvent"});
}

TEST_F(TrainerFaults, BagWithoutObservationsIsRefused) {
  const std::string bag = directory() + "/blind.bag";
  {
    rosbag::Bag file(bag, rosbag::bagmode::Write);
    for (const StampedPose& command : session().trajectories[0].commands)
      file.write("servo_cp", ros::Time(command.stamp),
                 stampedPoseToMsg(command.stamp, command.pose, "0_link"));
  }
  expectRefused(bag, {"no message on mocap/measured_cp"});
  // Nor is it one of "all bags of sessions" where none is named.
  fs::rename(bag, directory() + "/data/blind.bag");
  Retrain::Request request;
  request.dry_run = true;
  Retrain::Response response;
  EXPECT_TRUE(ros::service::call("/arm/trainer/retrain", request, response));
  EXPECT_TRUE(response.success) << response.message;
  fs::remove(directory() + "/data/blind.bag");
}

TEST_F(TrainerFaults, BagInWhichTheToolWasNeverSeenRightIsRefused) {
  Dataset blind = session();
  for (Trajectory& trajectory : blind.trajectories)
    for (StampedPose& seen : trajectory.observations) seen.pose.p.setConstant(std::nan(""));
  const std::string bag = directory() + "/nan.bag";
  if (!fs::exists(bag)) writeSessionBag(blind, bag);
  const Retrain::Response response = retrain({bag}, "");
  EXPECT_FALSE(response.success);
  EXPECT_NE(response.message.find("are not finite"), std::string::npos) << response.message;
  EXPECT_NE(response.message.find("ignore_checks"), std::string::npos) << response.message;
  expectNothingChanged();
}

// --- models --------------------------------------------------------------------------------------

TEST_F(TrainerFaults, WorseModelDoesNotGoLive) {
  const Retrain::Response worse = retrain({badBag()}, "");
  EXPECT_TRUE(worse.success) << worse.message;
  EXPECT_FALSE(worse.live);
  EXPECT_NE(worse.message.find("not better"), std::string::npos) << worse.message;
  // It is kept for those who want to look at it; what is live has not changed.
  ASSERT_EQ(worse.files.size(), 1u);
  EXPECT_TRUE(fs::exists(worse.files[0]));
  fs::remove(worse.files[0]);
  expectNothingChanged();
}

TEST_F(TrainerFaults, ModelsAreKeptWithIdHashTimeAndSourcesAndRolledBack) {
  const double start = std::floor(ros::WallTime::now().toSec());
  Retrain::Request request;
  request.bags = {goodBag(), "bad.bag"};  // relative: of the data directory
  request.force = true;
  badBag();
  Retrain::Response second;
  ASSERT_TRUE(ros::service::call("/arm/trainer/retrain", request, second));
  ASSERT_TRUE(second.success) << second.message;
  ASSERT_TRUE(second.live);
  ASSERT_EQ(second.files,
            std::vector<std::string>{directory() + "/models/" + second.model + ".bag"});
  const Correction kept = readModelFile(second.files[0]);
  EXPECT_EQ(kept.id, second.model);
  EXPECT_EQ(kept.input_hash.size(), 16u);
  EXPECT_NE(kept.id.find(kept.input_hash.substr(10)), std::string::npos);
  EXPECT_GE(kept.trained_at, start);
  EXPECT_LE(kept.trained_at, ros::WallTime::now().toSec());
  EXPECT_EQ(kept.inputs, (std::vector<std::string>{goodBag(), badBag()}));
  EXPECT_TRUE(waitFor([&] { return live() == second.model; }, kLimit));

  EXPECT_TRUE(trigger("rollback").success);
  EXPECT_TRUE(waitFor([&] { return live() == first_; }, kLimit));
  EXPECT_TRUE(fs::exists(second.files[0]));  // for ~load
  fs::remove(second.files[0]);
  expectNothingChanged();
}

}  // namespace
}  // namespace raven_correction

int main(int argc, char** argv) {
  return raven_correction::runNodeTests(argc, argv, "test_trainer");
}
