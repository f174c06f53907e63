// SPDX-License-Identifier: BSD-3-Clause
// Two arms in one simulator: does each have its own place, seed, motion and jaw, and does the loop
// that they share keep its rate?
#include <diagnostic_msgs/DiagnosticArray.h>
#include <gtest/gtest.h>
#include <ros/ros.h>
#include <sensor_msgs/JointState.h>
#include <tf2_msgs/TFMessage.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <future>
#include <map>
#include <mutex>
#include <set>
#include <vector>

#include "raven_correction/RunPlanner.h"
#include "raven_correction/TrajectoryEvent.h"
#include "raven_correction/ros/conversions.h"
#include "support/node_main.h"
#include "support/wait_for.h"

namespace raven_correction {
namespace {

constexpr double kLimit = 60.0;       // for a connection, and for a few motions [s]
constexpr unsigned kMotions = 3;      // to one fragment, up, and to the receptacle
constexpr double kLoopRate = 1000.0;  // of the controller, with clock_rate 1 [Hz]

/// Everything that one arm says. The lock is that of the test.
class Arm {
 public:
  Arm(const std::string& ns, std::mutex& mutex) : nh(ns), mutex_(mutex) {
    poses("measured_cp", measured);
    poses("setpoint_cp", setpoint);
    poses("mocap/measured_cp", mocap);
    subscribers_.push_back(
        nh.subscribe<sensor_msgs::JointState>("jaw/measured_js", 1000, [this](const auto& msg) {
          const std::lock_guard<std::mutex> lock(mutex_);
          jaw.push_back(msg->position.at(0));
        }));
    subscribers_.push_back(
        nh.subscribe<TrajectoryEvent>("trajectory_event", 100, [this](const auto& msg) {
          const std::lock_guard<std::mutex> lock(mutex_);
          events.push_back(*msg);
        }));
  }
  RunPlanner::Response run(unsigned seed) {
    RunPlanner call;
    call.request.trajectories = kMotions;
    call.request.seed = seed;
    EXPECT_TRUE(ros::service::call(nh.resolveName("planner/run"), call));
    return call.response;
  }

  ros::NodeHandle nh;
  std::vector<geometry_msgs::PoseStamped> measured, setpoint, mocap;
  std::vector<double> jaw;
  std::vector<TrajectoryEvent> events;

 private:
  void poses(const std::string& topic, std::vector<geometry_msgs::PoseStamped>& all) {
    subscribers_.push_back(
        nh.subscribe<geometry_msgs::PoseStamped>(topic, 1000, [this, &all](const auto& msg) {
          const std::lock_guard<std::mutex> lock(mutex_);
          all.push_back(*msg);
        }));
  }
  std::mutex& mutex_;
  std::vector<ros::Subscriber> subscribers_;
};

class TwoArms : public ::testing::Test {
 protected:
  TwoArms() : left("raven/left", mutex), right("raven/right", mutex), spinner(2) {
    diagnostics_ = nh_.subscribe<diagnostic_msgs::DiagnosticArray>(
        "/diagnostics", 100, [this](const auto& msg) {
          const std::lock_guard<std::mutex> lock(mutex);
          for (const auto& status : msg->status)
            if (status.name.find("simulator: ") != std::string::npos)
              for (const auto& value : status.values)
                diagnostics[status.name.substr(status.name.rfind(": ") + 2)][value.key].push_back(
                    value.value);
        });
    tf_ = nh_.subscribe<tf2_msgs::TFMessage>("/tf_static", 10, [this](const auto& msg) {
      const std::lock_guard<std::mutex> lock(mutex);
      for (const auto& transform : msg->transforms) {
        EXPECT_EQ(transform.header.frame_id, "0_link");
        EXPECT_EQ(transform.child_frame_id, "mocap");
        X_base_mocap = poseFromMsg(transform.transform);
        registered = true;
      }
    });
    spinner.start();
    for (Arm* const arm : {&left, &right})
      for (const char* const service : {"planner/run", "simulator/reset", "simulator/load"})
        EXPECT_TRUE(ros::service::waitForService(arm->nh.resolveName(service), 60000)) << service;
    EXPECT_TRUE(until([this] {
      return registered && left.mocap.size() > 1 && right.mocap.size() > 1 &&
             left.measured.size() > 1 && right.measured.size() > 1;
    }));
  }
  ~TwoArms() override { spinner.stop(); }

  /// Waits for what callbacks write.
  template <typename Condition>
  bool until(Condition condition) {
    return waitFor(
        [&] {
          const std::lock_guard<std::mutex> lock(mutex);
          return condition();
        },
        kLimit);
  }
  /// All values of a key so far, as numbers.
  std::vector<double> reported(const std::string& status, const std::string& key) {
    std::vector<double> values;
    for (const std::string& value : diagnostics[status][key]) values.push_back(std::stod(value));
    return values;
  }
  Pose registeredMocap(const geometry_msgs::PoseStamped& msg) const {
    return X_base_mocap * poseFromMsg(msg.pose);
  }

  std::mutex mutex;  // guards what follows, and what the arms say
  // Of the simulator: by status and key.
  std::map<std::string, std::map<std::string, std::vector<std::string>>> diagnostics;
  Pose X_base_mocap;
  bool registered = false;
  Arm left, right;
  ros::AsyncSpinner spinner;

 private:
  ros::NodeHandle nh_;
  ros::Subscriber diagnostics_, tf_;
};

TEST_F(TwoArms, EachIsInItsOwnPlaceInTheCommonFrame) {
  const std::lock_guard<std::mutex> lock(mutex);
  for (const Arm* const arm : {&left, &right}) {
    EXPECT_EQ(arm->measured.back().header.frame_id, "0_link");
    EXPECT_EQ(arm->mocap.back().header.frame_id, "mocap");
    // The arms err by centimetres, and are more than a decimetre apart.
    const Eigen::Vector3d seen = registeredMocap(arm->mocap.back()).p;
    EXPECT_LT((seen - poseFromMsg(arm->measured.back().pose).p).norm(), 0.06);
  }
  EXPECT_GT(
      (poseFromMsg(left.measured.back().pose).p - poseFromMsg(right.measured.back().pose).p).norm(),
      0.1);
}

// What a seed does is tested on the cell; here, that the arms do not share one.
TEST_F(TwoArms, EachHasASeedOfItsOwn) {
  ASSERT_TRUE(until(
      [this] { return !reported("left", "seed").empty() && !reported("right", "seed").empty(); }));
  const std::lock_guard<std::mutex> lock(mutex);
  EXPECT_EQ(reported("left", "seed").back(), 1.0);
  EXPECT_EQ(reported("right", "seed").back(), 2.0);
}

TEST_F(TwoArms, BothMoveAndGraspAtOnce) {
  const auto answer = [](Arm& arm, unsigned seed) {
    return std::async(std::launch::async, [&arm, seed] { return arm.run(seed); });
  };
  std::future<RunPlanner::Response> one = answer(left, 5);
  std::future<RunPlanner::Response> other = answer(right, 6);
  for (std::future<RunPlanner::Response>* const run : {&one, &other}) {
    const RunPlanner::Response response = run->get();
    EXPECT_TRUE(response.success) << response.message;
    EXPECT_EQ(response.trajectories, kMotions);
  }
  std::array<std::set<long>, 2> moving;  // tenths of a second in which a set-point was changing
  for (Arm* const arm : {&left, &right}) {
    ASSERT_TRUE(until([&] {
      if (arm->events.size() < 2 * kMotions) return false;
      const Pose target = poseFromMsg(arm->events.back().target);
      return (poseFromMsg(arm->setpoint.back().pose).p - target.p).norm() < 1e-6;
    })) << "the set-point never came to the last target";
    // The last motion ends with an open jaw, and it was closed between.
    EXPECT_TRUE(until([&] { return arm->jaw.back() == 0.8; }));
    const std::lock_guard<std::mutex> lock(mutex);
    const auto open = std::find(arm->jaw.begin(), arm->jaw.end(), 0.8);
    const auto closed = std::find(open, arm->jaw.end(), 0.0);
    EXPECT_NE(closed, arm->jaw.end());
    const std::string name = arm == &left ? "left" : "right";
    const std::vector<double> held = reported(name, "payload [g]");
    EXPECT_NE(std::find(held.begin(), held.end(), 0.5), held.end()) << "nothing was ever held";
    for (std::size_t i = 1; i < arm->setpoint.size(); ++i) {
      const auto& msg = arm->setpoint[i];
      if (msg.pose.position.x == arm->setpoint[i - 1].pose.position.x) continue;
      moving[arm == &left ? 0 : 1].insert(std::lround(10.0 * msg.header.stamp.toSec()));
    }
  }
  const auto both = std::count_if(moving[0].begin(), moving[0].end(),
                                  [&](long tenth) { return moving[1].count(tenth) > 0; });
  EXPECT_GT(both, 10) << "one moved after the other";
}

// Cycles against the clock that the simulator publishes: a busy machine makes both slow.
TEST_F(TwoArms, TheLoopKeepsItsRateAndCountsLateCycles) {
  const std::string controller = "controller";
  ASSERT_TRUE(until([&] { return reported(controller, "time [s]").size() >= 4; }));
  const std::lock_guard<std::mutex> lock(mutex);
  const std::vector<double> time = reported(controller, "time [s]");
  const std::vector<double> cycles = reported(controller, "cycles");
  const std::vector<double> late = reported(controller, "late cycles");
  const double rate = (cycles.back() - cycles.front()) / (time.back() - time.front());
  EXPECT_NEAR(rate, kLoopRate, 0.05 * kLoopRate);
  EXPECT_NEAR(reported(controller, "cycles per second of the clock").back(), kLoopRate,
              0.1 * kLoopRate);
  EXPECT_LE(late.back(), cycles.back());
  EXPECT_TRUE(std::is_sorted(late.begin(), late.end())) << "they are counted, not forgotten";
  std::printf("%.1f cycles per second of the clock, %.2f %% late\n", rate,
              100.0 * late.back() / cycles.back());
}

}  // namespace
}  // namespace raven_correction

int main(int argc, char** argv) {
  return raven_correction::runNodeTests(argc, argv, "test_demo_two_arms");
}
