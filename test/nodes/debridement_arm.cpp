// SPDX-License-Identifier: BSD-3-Clause
// What the debridement experiment works with, each alone: an arm that moves, measures and undoes
// its deviation, an eye for which the clock stands, and what the simulator tells of jaws and of
// instruments that come near one another.
#include "raven_correction/ros/debridement_arm.h"

#include <gtest/gtest.h>
#include <std_msgs/Float64.h>
#include <std_srvs/SetBool.h>
#include <std_srvs/Trigger.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "raven_correction/FragmentArray.h"
#include "raven_correction/JawEvent.h"
#include "raven_correction/LoadScene.h"
#include "raven_correction/TrajectoryEvent.h"
#include "raven_correction/ros/conversions.h"
#include "raven_correction/ros/field_eye.h"
#include "raven_correction/ros/jaw_event.h"
#include "raven_correction/ros/topics.h"
#include "support/node_main.h"
#include "support/wait_for.h"

namespace raven_correction {
namespace {

constexpr double kLimit = 30.0;  // for everything that takes a second [s]
constexpr char kSimulator[] = "/raven/simulator";
constexpr char kCamera[] = "/field_camera";

/// All messages of a topic, from the threads of the spinner.
template <typename Message>
class Collector {
 public:
  explicit Collector(const std::string& topic) {
    subscriber_ = ros::NodeHandle().subscribe<Message>(topic, 1000, [this](const auto& message) {
      const std::lock_guard<std::mutex> lock(mutex_);
      messages_.push_back(*message);
    });
    EXPECT_TRUE(waitFor([this] { return subscriber_.getNumPublishers() > 0; }, kLimit)) << topic;
  }
  std::vector<Message> all() const {
    const std::lock_guard<std::mutex> lock(mutex_);
    return messages_;
  }

 private:
  mutable std::mutex mutex_;
  std::vector<Message> messages_;
  ros::Subscriber subscriber_;  // last: its callback uses the above
};

double now() { return ros::Time::now().toSec(); }

bool pause(bool stand) {
  std_srvs::SetBool call;
  call.request.data = stand;
  return waitFor([&] { return ros::service::call(std::string(kSimulator) + "/pause", call); },
                 kLimit) &&
         call.response.success;
}

class DebridementArmTest : public ::testing::Test {
 protected:
  DebridementArmTest() : spinner_(3), eye(kCamera, kSimulator) {
    spinner_.start();
    EXPECT_TRUE(ros::service::waitForService(std::string(kSimulator) + "/pause", 20000));
    EXPECT_TRUE(
        ros::service::waitForService(std::string(kCamera) + "/simulator/take_picture", 20000));
    EXPECT_TRUE(ros::Time::waitForValid(ros::WallDuration(kLimit)));
    // The detector listens to the camera, and this process, with the eye, to the detector.
    const Collector<FragmentArray> fragments(std::string(kCamera) + "/fragments");
    EXPECT_TRUE(waitFor(
        [&] {
          std_srvs::Trigger picture;
          return ros::service::call(std::string(kCamera) + "/simulator/take_picture", picture) &&
                 !fragments.all().empty();
        },
        kLimit));
    left = std::make_unique<DebridementArm>("/raven/left", "0_link", eye, interrupted);
  }
  ~DebridementArmTest() override {
    EXPECT_TRUE(pause(false)) << "a clock that stands would hang the next test";
    spinner_.stop();
  }

  /// Above the middle of the field.
  static Pose overField() {
    return {{-0.06, -0.058, -0.130}, DebridementTaskConfig().orientation.normalized()};
  }
  /// Once the tool has come to rest, and the cameras see it.
  Eigen::Vector3d deviationAtRest() {
    std::optional<Eigen::Vector3d> off;
    for (int i = 0; i < 10 && !off; ++i) {
      left->wait(0.6);
      off = left->deviation();
    }
    EXPECT_TRUE(off.has_value());
    return off.value_or(Eigen::Vector3d::Constant(NAN));
  }
  double deviation() { return deviationAtRest().norm(); }
  /// Where the cameras see enough.
  bool replan() {
    for (int i = 0; i < 10; ++i)
      if (left->replanHere()) return true;
    return false;
  }

 private:
  ros::AsyncSpinner spinner_;

 protected:
  FieldEye eye;
  std::atomic<bool> interrupted{false};
  std::unique_ptr<DebridementArm> left;
};

TEST_F(DebridementArmTest, MovesWhereItIsToldAndAnnouncesIt) {
  Collector<TrajectoryEvent> events("/raven/left/trajectory_event");
  Collector<geometry_msgs::PoseStamped> setpoints("/raven/left/setpoint_cp");
  Pose target = overField();
  left->move("approach", target, 0.3);
  EXPECT_TRUE(waitFor(
      [&] {
        const auto all = setpoints.all();
        return !all.empty() && (poseFromMsg(all.back().pose).p - target.p).norm() < 1e-9;
      },
      kLimit));
  ASSERT_TRUE(waitFor([&] { return events.all().size() >= 2; }, kLimit));
  const std::vector<TrajectoryEvent> said = events.all();
  EXPECT_EQ(said[0].event, TrajectoryEvent::START);
  EXPECT_EQ(said[1].event, TrajectoryEvent::END);
  EXPECT_EQ(said[0].kind, "approach");
  EXPECT_EQ(said[0].trajectory, said[1].trajectory);
  EXPECT_LT((poseFromMsg(said[0].target).p - target.p).norm(), 1e-12);
  EXPECT_GT(said[1].header.stamp, said[0].header.stamp);

  interrupted = true;
  target.p.z() += 0.01;
  EXPECT_THROW(left->move("approach", target, 0.0), std::runtime_error);
}

TEST_F(DebridementArmTest, UndoesItsDeviationUntilItIsTakenBack) {
  left->move("approach", overField(), 0.3);
  const double before = deviation();
  EXPECT_GT(before, 0.010) << "the robot of the demo is off by centimetres";
  ASSERT_TRUE(replan());
  EXPECT_GT(left->measurements(), 0u);
  EXPECT_LT(deviation(), 0.25 * before) << "what play and the cameras leave of it";

  // The next move of an arm that does not replan on its way forgets what was measured here.
  Pose beside = overField();
  beside.p.y() += 0.01;
  left->move("approach", beside, 0.3);
  EXPECT_GT(deviation(), 0.010);

  ArmMotion keeping;
  keeping.replan_interval = 1e9;  // measured once
  left->use(keeping);
  left->move("approach", overField(), 0.3);
  left->measureAtRest();
  left->move("approach", beside, 0.3);
  EXPECT_LT(deviation(), 0.5 * before) << "one that does takes it along";
  left->takeBack();
  EXPECT_GT(deviation(), 0.010);
}

TEST_F(DebridementArmTest, APredictionIsOfThePoseThatWasSentLast) {
  ros::Publisher status =
      ros::NodeHandle().advertise<CorrectionStatus>("/raven/left/correction/status", 10);
  ASSERT_TRUE(waitFor([&] { return status.getNumSubscribers() > 0; }, kLimit));
  left->move("approach", overField(), 0.1);
  EXPECT_TRUE(std::isinf(left->predictedDeviation())) << "nobody has said anything yet";
  CorrectionStatus said;
  said.header.stamp = ros::Time::now();
  said.sd_position.x = 0.002;
  said.sd_position.y = 0.001;
  said.sd_position.z = 0.002;
  status.publish(said);
  EXPECT_TRUE(
      waitFor([&] { return std::abs(left->predictedDeviation() - 0.003) < 1e-12; }, kLimit));
  left->wait(0.5);  // poses that nobody says anything of
  EXPECT_TRUE(std::isinf(left->predictedDeviation()));
}

TEST_F(DebridementArmTest, AJawSaysWhenItOpensAndClosesAndWhere) {
  Collector<JawEvent> events(std::string("/raven/left/") + kJawEventTopic);
  left->move("approach", overField(), 0.3);
  left->setJaw(0.8, 0.5);
  left->setJaw(0.0, 0.5);
  ASSERT_TRUE(waitFor([&] { return events.all().size() >= 2; }, kLimit));
  const std::vector<JawEvent> said = events.all();
  ASSERT_EQ(said.size(), 2u);
  EXPECT_EQ(said[0].event, JawEvent::OPENED);
  EXPECT_GE(said[0].opening, 0.2);
  EXPECT_LT(said[0].opening, 0.8);
  EXPECT_EQ(said[1].event, JawEvent::CLOSED);
  EXPECT_EQ(said[1].opening, 0.8) << "the widest since it was opened";
  EXPECT_EQ(said[1].header.frame_id, "0_link");
  // The true tool: where motion capture sees it, not where it was sent.
  const Eigen::Vector3d off = deviationAtRest();
  EXPECT_LT((poseFromMsg(said[1].pose).p - (overField().p + off)).norm(), 0.002);
}

TEST_F(DebridementArmTest, SeesTheFieldWhileTheClockStands) {
  Collector<FragmentArray> truths(std::string(kCamera) + "/simulator/truth");
  LoadScene load;
  load.request.seed = 4;
  ASSERT_TRUE(waitFor([&] { return !truths.all().empty(); }, kLimit)) << "of the scene so far";
  const auto scenes = truths.all().size();
  ASSERT_TRUE(ros::service::call(std::string(kCamera) + "/simulator/load_scene", load));
  ASSERT_TRUE(waitFor([&] { return truths.all().size() > scenes; }, kLimit));
  const FragmentArray truth = truths.all().back();
  ASSERT_EQ(truth.fragments.size(), load.response.fragments);

  const double stood = eye.stood();
  const double begin = now();
  const FieldPicture picture = eye.look([] {});  // in no time
  EXPECT_GT(eye.stood(), stood);
  EXPECT_GE(picture.stamp, begin - 0.1);
  EXPECT_GE(picture.fragments.size(), (truth.fragments.size() + 1) / 2);
  for (const FragmentSighting& seen : picture.fragments) {
    double nearest = 1.0;
    for (const Fragment& fragment : truth.fragments)
      nearest = std::min(
          nearest, (Eigen::Vector3d(fragment.position.x, fragment.position.y, fragment.position.z) -
                    seen.p_field)
                       .norm());
    EXPECT_LT(nearest, 0.003);
  }
  EXPECT_TRUE(waitFor([&] { return now() > picture.stamp + 0.5; }, kLimit)) << "it goes on";
}

TEST_F(DebridementArmTest, AnEyeWithoutACameraSaysSoAndLetsTheClockGoOn) {
  FieldEye blind("/nowhere", kSimulator);
  EXPECT_THROW(blind.look([] {}), std::runtime_error);
  const double then = now();
  EXPECT_TRUE(waitFor([&] { return now() > then + 0.2; }, kLimit));
}

TEST_F(DebridementArmTest, AClockThatStandsHoldsEveryReport) {
  Collector<geometry_msgs::PoseStamped> measured("/raven/left/measured_cp");
  ASSERT_TRUE(waitFor([&] { return !measured.all().empty(); }, kLimit));
  ASSERT_TRUE(pause(true));
  double then = 0.0;
  std::size_t count = 0;
  int quiet = 0;
  ASSERT_TRUE(waitFor(
      [&] {  // 0.2 s: of a clock that runs, forty reports
        quiet = now() == then && measured.all().size() == count ? quiet + 1 : 0;
        then = now();
        count = measured.all().size();
        return quiet >= 40;
      },
      kLimit));
  ASSERT_TRUE(pause(false));
  ASSERT_TRUE(waitFor([&] { return measured.all().size() > count; }, kLimit));
  const std::vector<geometry_msgs::PoseStamped> all = measured.all();
  EXPECT_LT((all[count].header.stamp - all[count - 1].header.stamp).toSec(), 0.1)
      << "it goes on where it stood";
}

TEST_F(DebridementArmTest, TheSimulatorSaysHowNearInstrumentsCome) {
  Collector<std_msgs::Float64> clearance(std::string(kSimulator) + "/clearance");
  const auto leastOf = [&](const std::function<void()>& job) {
    const auto before = clearance.all().size();
    job();
    EXPECT_TRUE(waitFor([&] { return clearance.all().size() > before + 2; }, kLimit));
    double least = INFINITY;
    const std::vector<std_msgs::Float64> all = clearance.all();
    for (std::size_t i = before; i < all.size(); ++i) least = std::min(least, all[i].data);
    return least;
  };
  left->move("approach", overField(), 0.3);
  const double apart = leastOf([] {});
  Pose nearer = overField();
  nearer.p.x() -= 0.02;  // the other one is on that side
  const double together = leastOf([&] { left->move("approach", nearer, 0.3); });
  EXPECT_GT(together, 0.0);
  EXPECT_LT(together, apart - 0.003);
}

}  // namespace
}  // namespace raven_correction

int main(int argc, char** argv) {
  return raven_correction::runNodeTests(argc, argv, "test_debridement_arm");
}
