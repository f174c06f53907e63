// SPDX-License-Identifier: BSD-3-Clause
// Do all nodes together do what the package is for: record, learn, correct, and come closer to the
// targets? In small: few motions, so the demand is half of the error, not a fifth.
#include <gtest/gtest.h>
#include <ros/ros.h>
#include <std_srvs/SetBool.h>
#include <visualization_msgs/MarkerArray.h>

#include <cmath>
#include <filesystem>
#include <future>
#include <map>
#include <mutex>

#include "raven_correction/CorrectionModel.h"
#include "raven_correction/CorrectionStatus.h"
#include "raven_correction/Preflight.h"
#include "raven_correction/Retrain.h"
#include "raven_correction/RunPlanner.h"
#include "raven_correction/SetMode.h"
#include "raven_correction/StartRecording.h"
#include "raven_correction/StopRecording.h"
#include "raven_correction/evaluation/visits.h"
#include "raven_correction/ros/session_bag.h"
#include "support/node_main.h"
#include "support/wait_for.h"

namespace raven_correction {
namespace {

constexpr double kLimit = 60.0;  // for a connection [s]
constexpr unsigned kTargets = 6;
constexpr unsigned kTrainingMotions = 24;

class Demo : public ::testing::Test {
 protected:
  Demo() : nh("raven/left"), spinner(2) {
    EXPECT_TRUE(ros::param::get("/directory", directory));
    status_ = nh.subscribe<CorrectionStatus>("correction/status", 1000, [this](const auto& msg) {
      const std::lock_guard<std::mutex> lock(mutex);
      ++codes[msg->code];
    });
    model_ = nh.subscribe<CorrectionModel>("correction/model", 1, [this](const auto& msg) {
      const std::lock_guard<std::mutex> lock(mutex);
      model = msg->id;
    });
    overlay_ =
        nh.subscribe<visualization_msgs::MarkerArray>("overlay", 10, [this](const auto& msg) {
          const std::lock_guard<std::mutex> lock(mutex);
          markers += msg->markers.size();
        });
    spinner.start();
    for (const char* service : {"recorder/start", "planner/run", "trainer/retrain",
                                "corrector/enable", "simulator/reset"})
      EXPECT_TRUE(ros::service::waitForService(nh.resolveName(service), 60000)) << service;
  }
  ~Demo() override { spinner.stop(); }

  template <typename Service>
  typename Service::Response call(const std::string& name,
                                  const typename Service::Request& request) {
    typename Service::Response response;
    EXPECT_TRUE(ros::service::call(nh.resolveName(name), request, response)) << name;
    EXPECT_TRUE(response.success) << name << ": " << response.message;
    return response;
  }
  /// @return the bag
  std::string record(const std::string& name, unsigned motions, unsigned seed, double turn = 0.0,
                     double margin = 0.0) {
    StartRecording::Request start;
    start.bag = name;
    call<StartRecording>("recorder/start", start);
    RunPlanner::Request run;
    run.trajectories = motions;
    run.seed = seed;
    run.turn = turn;
    run.margin = margin;
    EXPECT_EQ(call<RunPlanner>("planner/run", run).trajectories, motions);
    const StopRecording::Response stop = call<StopRecording>("recorder/stop", {});
    EXPECT_EQ(stop.trajectories, motions);
    EXPECT_GT(stop.pairs, 0u);
    EXPECT_EQ(stop.bags.size(), 1u);
    return stop.bags.empty() ? "" : stop.bags.front();
  }
  /// What callbacks have written, at this moment.
  template <typename T>
  T seen(const T& value) {
    const std::lock_guard<std::mutex> lock(mutex);
    return value;
  }
  static std::vector<Visit> visits(const std::string& bag) {
    const Session session = readSessionBag(bag);
    std::vector<Visit> all;
    for (std::size_t i = 0; i < session.goals.size(); ++i)
      all.push_back(measureVisit(session.goals[i].trajectory, session.goals[i].target,
                                 session.dataset.trajectories[i].observations, session.goals[i].end,
                                 0.3));
    return all;
  }

  ros::NodeHandle nh;
  ros::AsyncSpinner spinner;
  std::string directory;

  std::mutex mutex;               // guards what follows
  std::map<int, unsigned> codes;  // of the corrector's status
  std::string model;
  std::size_t markers = 0;

 private:
  ros::Subscriber status_, model_, overlay_;
};

TEST_F(Demo, RecordsLearnsCorrectsAndComesCloser) {
  const std::string before = record("before.bag", kTargets, 11);
  const std::string training = record("training.bag", kTrainingMotions, 12, 0.35, 0.025);
  const auto uncorrected = seen(codes);
  EXPECT_EQ(uncorrected.count(CorrectionStatus::PASSED_OFF), 1u);
  for (const auto& [code, count] : uncorrected)  // a stale pose now and then on a busy machine
    EXPECT_TRUE(code == CorrectionStatus::PASSED_OFF ||
                code >= CorrectionStatus::REFUSED_NOT_FINITE)
        << "switched off, it has corrected " << count << " poses with code " << code;

  Retrain::Request retrain;
  retrain.bags = {training};
  const Retrain::Response learnt = call<Retrain>("trainer/retrain", retrain);
  EXPECT_TRUE(learnt.live) << learnt.message;
  EXPECT_LT(learnt.position_after_mm, learnt.position_before_mm);
  EXPECT_TRUE(waitFor([&] { return seen(model) == learnt.model; }, kLimit));
  for (const std::string& file : learnt.files) EXPECT_TRUE(std::filesystem::exists(file)) << file;

  // Nothing is switched on before a few moves have shown that the model is valid for this robot.
  std_srvs::SetBool::Request too_early;
  too_early.data = true;
  std_srvs::SetBool::Response refused;
  // The model needs a moment to get there.
  EXPECT_TRUE(waitFor(
      [&] {
        return ros::service::call(nh.resolveName("corrector/enable"), too_early, refused) &&
               refused.message.find(learnt.model) != std::string::npos;
      },
      30.0));
  EXPECT_FALSE(refused.success) << refused.message;
  auto preflight = std::async(std::launch::async, [&] {
    Preflight::Request request;
    request.duration = 120.0;
    return call<Preflight>("corrector/preflight", request);
  });
  RunPlanner::Request moves;
  moves.trajectories = 10;
  moves.seed = 13;
  call<RunPlanner>("planner/run", moves);
  const Preflight::Response judged = preflight.get();
  EXPECT_TRUE(judged.passed) << judged.message;
  EXPECT_EQ(judged.model, learnt.model);
  EXPECT_TRUE(judged.findings.empty()) << judged.findings[0];

  SetMode::Request mode;
  mode.mode = "full";
  call<SetMode>("corrector/set_mode", mode);
  std_srvs::SetBool::Request enable;
  enable.data = true;
  call<std_srvs::SetBool>("corrector/enable", enable);
  const std::string after = record("after.bag", kTargets, 11);
  EXPECT_EQ(seen(codes).count(CorrectionStatus::CORRECTED), 1u);

  const VisitComparison comparison = compareVisits(visits(before), visits(after));
  EXPECT_EQ(comparison.before.size(), kTargets);
  EXPECT_GT(comparison.summary_before.position_norm, 0.005);
  EXPECT_LT(comparison.summary_after.position_norm, 0.5 * comparison.summary_before.position_norm);
  EXPECT_LT(comparison.summary_after.angle_norm, 0.5 * comparison.summary_before.angle_norm);
  EXPECT_GT(seen(markers), 0u);
}

}  // namespace
}  // namespace raven_correction

int main(int argc, char** argv) { return raven_correction::runNodeTests(argc, argv, "test_demo"); }
