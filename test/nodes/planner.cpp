// SPDX-License-Identifier: BSD-3-Clause
// The planner from outside: are its events in order and true, are its motions those of the seed and
// within their limits, and does it stop when told to?
#include <geometry_msgs/PoseArray.h>
#include <gtest/gtest.h>
#include <ros/ros.h>
#include <std_srvs/Trigger.h>

#include <algorithm>
#include <cmath>
#include <future>
#include <mutex>
#include <utility>
#include <vector>

#include "raven_correction/RunPlanner.h"
#include "raven_correction/TrajectoryEvent.h"
#include "raven_correction/WorkProgress.h"
#include "raven_correction/error.h"
#include "raven_correction/ros/conversions.h"
#include "raven_correction/ros/planner_node.h"
#include "raven_correction/simulation/simulation_config.h"
#include "support/node_main.h"
#include "support/wait_for.h"

namespace raven_correction {
namespace {

constexpr double kLimit = 30.0;     // for a run that takes a few seconds [s]
constexpr double kPeriod = 0.02;    // of the commands, as config/planner.yaml says [s]
constexpr double kSpeed = 0.2;      // as planner.test says [m/s]
constexpr double kTurnSpeed = 4.0;  // [rad/s]
const Pose kHome{{-0.02, -0.04, -0.12}, Eigen::Quaterniond(0.5, 0.5, 0.5, -0.5)};

struct Heard {
  PoseStream desired;
  std::vector<TrajectoryEvent> events;
  std::vector<geometry_msgs::PoseArray> paths;
  std::size_t jaw = 0;  // commands to it
};

/// Callbacks run in a spinner of two threads, so a call of ~run may wait for its answer.
class Planner : public ::testing::Test {
 protected:
  Planner() : nh("raven/left"), spinner(2) {
    desired_ = nh.subscribe<geometry_msgs::PoseStamped>(
        "desired/servo_cp", 1000, [this](const auto& message) {
          const std::lock_guard<std::mutex> lock(mutex);
          EXPECT_EQ(message->header.frame_id, "0_link");
          heard.desired.push_back(stampedPoseFromMsg(*message));
        });
    events_ = nh.subscribe<TrajectoryEvent>("trajectory_event", 100, [this](const auto& message) {
      const std::lock_guard<std::mutex> lock(mutex);
      heard.events.push_back(*message);
    });
    paths_ =
        nh.subscribe<geometry_msgs::PoseArray>("desired/path", 100, [this](const auto& message) {
          const std::lock_guard<std::mutex> lock(mutex);
          heard.paths.push_back(*message);
        });
    jaw_ = nh.subscribe<sensor_msgs::JointState>("jaw/servo_jp", 100, [this](const auto&) {
      const std::lock_guard<std::mutex> lock(mutex);
      ++heard.jaw;
    });
    progress_ = nh.subscribe<WorkProgress>("planner/progress", 100, [this](const auto& message) {
      const std::lock_guard<std::mutex> lock(mutex);
      progress = *message;
    });
    spinner.start();
    EXPECT_TRUE(ros::service::waitForService(nh.resolveName("planner/run"), 20000));
    EXPECT_TRUE(waitFor(
        [this] {
          return desired_.getNumPublishers() > 0 && events_.getNumPublishers() > 0 &&
                 paths_.getNumPublishers() > 0 && jaw_.getNumPublishers() > 0;
        },
        kLimit));
  }
  ~Planner() override { spinner.stop(); }

  RunPlanner::Response run(unsigned trajectories, unsigned seed, const std::string& prefix = "") {
    RunPlanner call;
    call.request.trajectories = trajectories;
    call.request.seed = seed;
    call.request.prefix = prefix;
    EXPECT_TRUE(ros::service::call(nh.resolveName("planner/run"), call));
    return call.response;
  }
  /// A run with everything that was heard of it.
  Heard runAndHear(unsigned trajectories, unsigned seed) {
    clear();
    const RunPlanner::Response response = run(trajectories, seed);
    EXPECT_TRUE(response.success) << response.message;
    EXPECT_EQ(response.trajectories, trajectories);
    EXPECT_TRUE(waitForEvents(2 * trajectories));
    return copy();
  }
  bool waitForEvents(std::size_t count) {
    return waitFor([&] { return copy().events.size() >= count; }, kLimit);
  }
  void clear() {
    const std::lock_guard<std::mutex> lock(mutex);
    heard = Heard();
  }
  Heard copy() {
    const std::lock_guard<std::mutex> lock(mutex);
    return heard;
  }
  /// Says where the controller aims, latched, as long as the test lives.
  void aimAt(const Pose& pose) {
    setpoint_ = nh.advertise<geometry_msgs::PoseStamped>("setpoint_cp", 1, true);
    setpoint_.publish(stampedPoseToMsg(ros::Time::now().toSec(), pose, "0_link"));
    ASSERT_TRUE(waitFor([this] { return setpoint_.getNumSubscribers() > 0; }, kLimit));
  }

  ros::NodeHandle nh;
  ros::AsyncSpinner spinner;
  std::mutex mutex;
  Heard heard;
  WorkProgress progress;

 private:
  ros::Subscriber desired_, events_, paths_, jaw_, progress_;
  ros::Publisher setpoint_;
};

TEST_F(Planner, DoesNotMoveAsLongAsTheStartIsUnknown) {  // the first test: nobody has said it yet
  const RunPlanner::Response response = run(1, 5);
  EXPECT_FALSE(response.success);
  EXPECT_NE(response.message.find("setpoint_cp"), std::string::npos) << response.message;
  EXPECT_TRUE(copy().desired.empty());
}

TEST_F(Planner, EventsEncloseTheCommandsOfTheirTrajectory) {
  aimAt(kHome);
  const Heard all = runAndHear(3, 5);
  ASSERT_EQ(all.events.size(), 6u);
  ASSERT_EQ(all.paths.size(), 3u);
  EXPECT_EQ(all.jaw, 0u) << "nothing to grasp on the way from one fragment to the next";
  for (std::size_t i = 0; i < 3; ++i) {
    const TrajectoryEvent& start = all.events[2 * i];
    const TrajectoryEvent& end = all.events[2 * i + 1];
    EXPECT_EQ(start.event, TrajectoryEvent::START);
    EXPECT_EQ(end.event, TrajectoryEvent::END);
    EXPECT_EQ(start.trajectory, "t00" + std::to_string(i));
    EXPECT_EQ(end.trajectory, start.trajectory);
    EXPECT_FALSE(start.kind.empty());
    PoseStream inside;
    for (const StampedPose& command : all.desired)
      if (command.stamp >= start.header.stamp.toSec() && command.stamp <= end.header.stamp.toSec())
        inside.push_back(command);
    ASSERT_FALSE(inside.empty());
    EXPECT_EQ(inside.front().stamp, start.header.stamp.toSec());
    EXPECT_EQ(inside.back().stamp, end.header.stamp.toSec());
    const Pose target = poseFromMsg(end.target);
    EXPECT_EQ(inside.back().pose.p, target.p);
    EXPECT_EQ(poseFromMsg(start.target).p, target.p);
    EXPECT_EQ(all.paths[i].poses.size(), inside.size());
    EXPECT_EQ(poseFromMsg(all.paths[i].poses.back()).p, target.p);
    // The dwell: the last commands are the target itself.
    const std::size_t resting = static_cast<std::size_t>(0.1 / kPeriod);
    ASSERT_GT(inside.size(), resting);
    EXPECT_EQ(inside[inside.size() - resting].pose.p, target.p);
  }
}

TEST_F(Planner, NeverJumpsNotEvenFromWhereTheRobotIs) {
  Pose elsewhere = kHome;
  elsewhere.p += Eigen::Vector3d(0.02, -0.02, -0.02);
  aimAt(elsewhere);
  const Heard all = runAndHear(2, 9);
  ASSERT_GT(all.desired.size(), 10u);
  EXPECT_LT((all.desired.front().pose.p - elsewhere.p).norm(), 1e-9);
  for (std::size_t i = 1; i < all.desired.size(); ++i) {
    const StampedPose& a = all.desired[i - 1];
    const StampedPose& b = all.desired[i];
    ASSERT_GT(b.stamp, a.stamp);
    EXPECT_LT((b.pose.p - a.pose.p).norm(), 1.05 * kSpeed * kPeriod);
    EXPECT_LT(rotationAngle(a.pose.q, b.pose.q), 1.05 * kTurnSpeed * kPeriod);
  }
}

TEST_F(Planner, EqualSeedsVisitEqualTargets) {
  aimAt(kHome);
  const Heard one = runAndHear(3, 42);
  const Heard same = runAndHear(3, 42);
  const Heard other = runAndHear(3, 43);
  for (std::size_t i = 0; i < one.events.size(); ++i) {
    EXPECT_EQ(poseFromMsg(one.events[i].target).p, poseFromMsg(same.events[i].target).p);
    EXPECT_EQ(poseFromMsg(one.events[i].target).q.coeffs(),
              poseFromMsg(same.events[i].target).q.coeffs());
    EXPECT_GT((poseFromMsg(one.events[i].target).p - poseFromMsg(other.events[i].target).p).norm(),
              1e-4);
  }
  for (std::size_t i = 0; i < one.paths.size(); ++i)
    EXPECT_EQ(one.paths[i].poses.size(), same.paths[i].poses.size());
}

TEST_F(Planner, StopsInTheMiddleAndSaysThatTheTargetWasNotReached) {
  aimAt(kHome);
  clear();
  std::future<RunPlanner::Response> running =
      std::async(std::launch::async, [this] { return run(200, 7, "s"); });
  ASSERT_TRUE(waitForEvents(3));  // in the second motion

  const RunPlanner::Response refused = run(1, 1);
  EXPECT_FALSE(refused.success) << "two runs at once";

  std_srvs::Trigger stop;
  ASSERT_TRUE(ros::service::call(nh.resolveName("planner/stop"), stop));
  EXPECT_TRUE(stop.response.success) << stop.response.message;
  const RunPlanner::Response response = running.get();
  EXPECT_FALSE(response.success);
  EXPECT_LT(response.trajectories, 200u);
  EXPECT_NE(response.message.find("stopped"), std::string::npos) << response.message;

  ASSERT_TRUE(waitFor([this] { return copy().events.size() % 2 == 0; }, kLimit));
  const Heard all = copy();
  EXPECT_EQ(all.events.back().event, TrajectoryEvent::END);
  if (response.trajectories * 2 < all.events.size()) {  // not stopped in the silence between two
    EXPECT_EQ(all.events.back().target.orientation.w, 0.0);
    EXPECT_EQ(poseFromMsg(all.events.back().target).p.norm(), 0.0);
  }
  EXPECT_TRUE(waitFor(
      [this] {
        const std::lock_guard<std::mutex> lock(mutex);
        return progress.state == WorkProgress::FAILED;
      },
      kLimit));

  ASSERT_TRUE(ros::service::call(nh.resolveName("planner/stop"), stop));
  EXPECT_TRUE(stop.response.success) << "stopping what is at rest is no error";
}

TEST_F(Planner, RefusesARunOfNothingAndASpeedThatIsNone) {
  aimAt(kHome);
  EXPECT_FALSE(run(0, 1).success);
  RunPlanner call;
  call.request.trajectories = 1;
  call.request.speed = std::numeric_limits<double>::quiet_NaN();
  ASSERT_TRUE(ros::service::call(nh.resolveName("planner/run"), call));
  EXPECT_FALSE(call.response.success);
  EXPECT_NE(call.response.message.find("speed"), std::string::npos) << call.response.message;
  call.request.speed = 0.0;
  call.request.turn = -0.1;
  ASSERT_TRUE(ros::service::call(nh.resolveName("planner/run"), call));
  EXPECT_FALSE(call.response.success);
  EXPECT_NE(call.response.message.find("turn"), std::string::npos) << call.response.message;
  call.request.turn = 0.0;
  call.request.margin = 0.5;
  ASSERT_TRUE(ros::service::call(nh.resolveName("planner/run"), call));
  EXPECT_FALSE(call.response.success);
  EXPECT_NE(call.response.message.find("margin"), std::string::npos) << call.response.message;
}

TEST_F(Planner, VisitsTheTargetsItIsGivenInTheirOrder) {
  aimAt(kHome);
  clear();
  std::vector<Pose> targets(3, Pose{DebridementConfig().field_centre, kHome.q});
  targets[1].p += Eigen::Vector3d(0.02, -0.01, 0.005);
  targets[2] = targets[0];
  RunPlanner call;
  for (const Pose& target : targets) call.request.targets.push_back(poseToMsg(target));
  ASSERT_TRUE(ros::service::call(nh.resolveName("planner/run"), call));
  EXPECT_TRUE(call.response.success) << call.response.message;
  EXPECT_EQ(call.response.trajectories, 3u);
  ASSERT_TRUE(waitForEvents(6));
  const Heard all = copy();
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_LT((poseFromMsg(all.events[2 * i + 1].target).p - targets[i].p).norm(), 1e-12);
    EXPECT_LT(rotationAngle(poseFromMsg(all.paths[i].poses.back()).q, targets[i].q), 1e-9);
  }
}

TEST_F(Planner, RefusesTargetsThatAreNoneAndMovesToNoneOfThem) {
  aimAt(kHome);
  clear();
  const Pose good{DebridementConfig().field_centre, kHome.q};
  Pose millimetres = good, no_rotation = good, nowhere = good;
  millimetres.p *= 1e3;
  no_rotation.q.coeffs() *= 0.5;
  nowhere.p.x() = std::nan("");
  for (const auto& [bad, part] :
       {std::pair(millimetres, "metres"), {no_rotation, "unit quaternion"}, {nowhere, "finite"}}) {
    RunPlanner call;
    call.request.targets = {poseToMsg(good), poseToMsg(bad)};
    ASSERT_TRUE(ros::service::call(nh.resolveName("planner/run"), call));
    EXPECT_FALSE(call.response.success);
    EXPECT_NE(call.response.message.find(part), std::string::npos) << call.response.message;
    EXPECT_NE(call.response.message.find("target 1"), std::string::npos) << call.response.message;
  }
  RunPlanner call;
  call.request.trajectories = 5;
  call.request.targets = {poseToMsg(good)};
  ASSERT_TRUE(ros::service::call(nh.resolveName("planner/run"), call));
  EXPECT_FALSE(call.response.success);
  EXPECT_TRUE(copy().events.empty());
}

TEST_F(Planner, TurnsTheToolFurtherWhenAsked) {
  aimAt(kHome);
  clear();
  RunPlanner call;
  call.request.trajectories = 6;
  call.request.seed = 3;
  call.request.turn = 0.3;
  ASSERT_TRUE(ros::service::call(nh.resolveName("planner/run"), call));
  EXPECT_TRUE(call.response.success) << call.response.message;
  ASSERT_TRUE(waitForEvents(12));
  // The shipped deviation of 0.1 rad keeps every axis within two of it, and so every angle below
  // sqrt(3) 0.2; of six poses drawn with 0.3, all that close is a chance below one in a thousand.
  const Eigen::Quaterniond mean = DebridementConfig().orientation.normalized();
  double largest = 0.0;
  for (const TrajectoryEvent& event : copy().events)
    largest = std::max(largest, rotationAngle(poseFromMsg(event.target).q, mean));
  EXPECT_GT(largest, std::sqrt(3.0) * 0.2);
}

TEST(PlannerParams, TheShippedFileHoldsTheDefaults) {
  const PlannerParams shipped = loadPlannerParams(ros::NodeHandle("/shipped"));
  const PlannerParams defaults;
  EXPECT_EQ(shipped.base_frame, defaults.base_frame);
  EXPECT_EQ(shipped.debridement, defaults.debridement);
  EXPECT_EQ(shipped.silence, defaults.silence);
  EXPECT_EQ(shipped.stop_time, defaults.stop_time);
  EXPECT_EQ(shipped.start_timeout, defaults.start_timeout);
  EXPECT_EQ(shipped.motion.field_centre, defaults.motion.field_centre);
  EXPECT_EQ(shipped.motion.field_size, defaults.motion.field_size);
  EXPECT_EQ(shipped.motion.receptacle, defaults.motion.receptacle);
  EXPECT_EQ(shipped.motion.box_lower, defaults.motion.box_lower);
  EXPECT_EQ(shipped.motion.box_upper, defaults.motion.box_upper);
  EXPECT_LT(rotationAngle(shipped.motion.orientation, defaults.motion.orientation.normalized()),
            1e-9);
  EXPECT_EQ(shipped.motion.orientation_deviation, defaults.motion.orientation_deviation);
  for (const DebridementField& field : debridementFields())
    EXPECT_EQ(shipped.motion.*field.value, defaults.motion.*field.value) << field.key;
}

// What the planner of the right arm is told is what sessions of the simulated right arm do.
TEST(PlannerParams, TheRightArmHasTheFieldOfItsSimulation) {
  const PlannerParams params = loadPlannerParams(ros::NodeHandle("/shipped_right"));
  std::string directory;
  ASSERT_TRUE(ros::param::get("/configuration", directory));
  const DebridementConfig simulated =
      loadSimulationConfig(directory + "/simulation/raven2_right.yaml").debridement;
  EXPECT_EQ(params.motion.field_centre, simulated.field_centre);
  EXPECT_EQ(params.motion.receptacle, simulated.receptacle);
  EXPECT_EQ(params.motion.box_lower, simulated.box_lower);
  EXPECT_EQ(params.motion.box_upper, simulated.box_upper);
}

TEST(PlannerParams, AllProblemsAreNamedAtOnce) {
  std::string text;
  try {
    loadPlannerParams(ros::NodeHandle("/bad"));
  } catch (const InvalidInput& error) {
    text = error.what();
  }
  for (const char* part : {"~robot", "~motion", "~field_size", "did you mean dwell?"})
    EXPECT_NE(text.find(part), std::string::npos) << part << " is missing in\n" << text;
}

}  // namespace
}  // namespace raven_correction

int main(int argc, char** argv) {
  return raven_correction::runNodeTests(argc, argv, "test_planner");
}
