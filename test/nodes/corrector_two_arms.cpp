// SPDX-License-Identifier: BSD-3-Clause
// Both arms on one topic under the limits as shipped: does a command that is refused for one arm
// leave the other as it was, and do increments and single parts make the command jump? What the
// bytes of a RavenCommand become is raven_command.py.
#include <gtest/gtest.h>
#include <ros/package.h>
#include <ros/ros.h>

#include <array>

#include "raven_correction/CorrectionModel.h"
#include "raven_correction/CorrectionStatus.h"
#include "raven_correction/SetMode.h"
#include "raven_correction/robot/chain_file.h"
#include "raven_correction/ros/conversions.h"
#include "raven_correction/ros/model_file.h"
#include "raven_correction/ros/raven_command.h"
#include "support/node_main.h"
#include "support/raven_bytes.h"
#include "support/spin_until.h"

namespace raven_correction {
namespace {

// config/corrector.yaml
constexpr double kTranslationRate = 0.15, kMaxStepTime = 0.1;
constexpr double kLargestStep = kTranslationRate * kMaxStepTime;
constexpr double kStampResolution = 1e-7;  // a time of today as a double is good to 0.2 us
constexpr double kPeriod = 0.01;           // of the commands [s]
constexpr double kLimit = 20.0;            // for what takes milliseconds on an idle machine [s]
constexpr std::uint8_t kAbsolute = kRavenPositionEnabled | kRavenOrientationEnabled;

struct Asked {
  Pose pose;
  std::uint8_t option = kAbsolute;
};

KinematicChain chainOf(const std::string& robot) {
  return loadKinematicChain(ros::package::getPath("raven_correction") + "/config/robots/" + robot +
                            ".yaml");
}

/// The tool with the arm at home, but the insertion so far from its end [m].
Pose beforeTheEnd(const KinematicChain& chain, double distance) {
  JointVector q = chain.home();
  const int insertion = chain.indexOf("insertion");
  q(insertion) = chain.lower()(insertion) + distance;
  return chain.forward(q);
}

/// A model that is its rigid step alone, everywhere within a metre: a translation.
Correction shift(const std::string& arm, const Eigen::Vector3d& by) {
  static int number = 0;
  Correction model;
  model.id = "shift_" + std::to_string(++number);
  model.version = "test";
  model.frame = "0_link";
  model.arm = arm;
  model.rigid.p = by;
  model.motion.velocity = VelocityKind::kNone;
  model.trust.workspace_min.setConstant(-1.0);
  model.trust.workspace_max.setConstant(1.0);
  return model;
}

class TwoArms : public ::testing::Test {
 protected:
  static constexpr std::size_t kLeft = 0, kRight = 1;

  TwoArms() {
    publisher_ = nh_.advertise<RavenCommand>("desired/servo_cp", 10);
    subscribers_.push_back(nh_.subscribe<RavenCommand>(
        "servo_cp", 100, [this](const auto& message) { sent_.push_back(message->bytes); }));
    const char* const sides[] = {"left", "right"};
    for (std::size_t i = 0; i < 2; ++i) {
      const std::string side = sides[i];
      subscribers_.push_back(nh_.subscribe<CorrectionStatus>(
          side + "/correction/status", 100,
          [this, i](const auto& message) { statuses_[i].push_back(*message); }));
      models_[i] = nh_.advertise<CorrectionModel>(side + "/correction/model", 1, true);
    }
    EXPECT_TRUE(ros::service::waitForService("/raven/corrector/left/set_mode", 30000));
    EXPECT_TRUE(until([this] {
      bool all = publisher_.getNumSubscribers() == 1;
      for (const auto& subscriber : subscribers_) all &= subscriber.getNumPublishers() == 1;
      for (const auto& model : models_) all &= model.getNumSubscribers() == 1;
      return all;
    }));
  }

  template <typename Condition>
  bool until(Condition condition) {
    return spinUntil(condition, kLimit);
  }

  /// Sends one command and waits for the answers, which statuses_ then end with.
  void send(const std::array<Asked, 2>& asked) {
    stamp_ = std::max(stamp_ + ros::Duration(kPeriod), started_);
    std::vector<ArmBytes> arms;
    for (std::size_t i = 0; i < asked.size(); ++i)
      arms.push_back(armBytes(i == kLeft ? "L" : "R", asked[i].option, asked[i].pose));
    const std::size_t left = statuses_[kLeft].size(), right = statuses_[kRight].size();
    RavenCommand message;
    message.bytes = raven_correction::command(arms, stamp_.sec, stamp_.nsec);
    publisher_.publish(message);
    ASSERT_TRUE(
        until([&] { return statuses_[kLeft].size() > left && statuses_[kRight].size() > right; }));
  }
  std::uint8_t code(std::size_t arm) const { return statuses_[arm].back().code; }
  Pose command(std::size_t arm) const { return poseFromMsg(statuses_[arm].back().command); }

  /// Until both corrections are there in full.
  void sendUntilCorrected(const std::array<Asked, 2>& asked) {
    ASSERT_TRUE(until([&] {
      send(asked);
      return code(kLeft) == CorrectionStatus::RIGID_ONLY &&
             code(kRight) == CorrectionStatus::RIGID_ONLY;
    }));
  }

  static void setMode(const std::string& side, const std::string& mode) {
    SetMode call;
    call.request.mode = mode;
    EXPECT_TRUE(ros::service::call("/raven/corrector/" + side + "/set_mode", call));
    EXPECT_TRUE(call.response.success) << call.response.message;
  }

  ros::NodeHandle nh_{"raven"};
  ros::Publisher publisher_;
  std::array<ros::Publisher, 2> models_;
  std::vector<ros::Subscriber> subscribers_;
  std::vector<std::vector<std::uint8_t>> sent_;
  std::array<std::vector<CorrectionStatus>, 2> statuses_;
  const ros::Time started_ = ros::Time::now();
  static ros::Time stamp_;  // of the last command of all tests
};

ros::Time TwoArms::stamp_;

TEST_F(TwoArms, CommandRefusedForOneArmLeavesTheOtherAsItWas) {
  const KinematicChain right = chainOf("raven2_right");
  const Pose far = beforeTheEnd(right, 0.08), near = beforeTheEnd(right, 0.001);
  const KinematicChain left = chainOf("raven2_left");
  const Pose at_home = beforeTheEnd(left, 0.15);
  const Eigen::Vector3d outwards = (beforeTheEnd(left, 0.1).p - at_home.p).normalized();
  models_[kLeft].publish(modelToMsg(shift("raven2_left", 0.05 * outwards)));
  models_[kRight].publish(modelToMsg(shift("raven2_right", 0.05 * (near.p - far.p).normalized())));
  setMode("left", "full");
  sendUntilCorrected({Asked{at_home}, Asked{far}});
  const Pose before = command(kLeft);
  ASSERT_NEAR((before.p - at_home.p).norm(), 0.05, 1e-9);

  // The left arm is to give its correction back, while the right one jumps to where its own
  // correction leads out of reach.
  setMode("left", "off");
  const std::size_t sent = sent_.size();
  send({Asked{at_home}, Asked{near}});
  int refused = 0;
  while (code(kRight) == CorrectionStatus::REFUSED_UNREACHABLE && refused < 1000) {
    EXPECT_EQ(code(kLeft), CorrectionStatus::REFUSED_WITH_OTHER_ARM);
    ++refused;
    send({Asked{at_home}, Asked{near}});
  }
  EXPECT_GT(refused, 20);
  ASSERT_TRUE(until([&] { return sent_.size() > sent; }));
  EXPECT_EQ(sent_.size(), sent + 1);
  // What was not sent has not happened: the left arm goes on from its last command.
  EXPECT_LE((command(kLeft).p - before.p).norm(), kLargestStep + kStampResolution);
  EXPECT_LT(code(kLeft), 16);
}

TEST_F(TwoArms, PartsThatCannotBeCorrectedGiveTheirCorrectionBackInSteps) {
  const KinematicChain left = chainOf("raven2_left"), right = chainOf("raven2_right");
  const Pose rest = beforeTheEnd(right, 0.1), desired = beforeTheEnd(left, 0.15);
  const Eigen::Vector3d outwards = (beforeTheEnd(left, 0.1).p - desired.p).normalized();
  models_[kLeft].publish(modelToMsg(shift("raven2_left", 0.05 * outwards)));
  models_[kRight].publish(modelToMsg(shift("raven2_right", {0.0, 0.0, 1e-3})));
  setMode("left", "full");
  constexpr double kStep = kTranslationRate * kPeriod + kStampResolution;
  constexpr std::uint8_t kTurnedBy = kAbsolute | kRavenOrientationRelative;
  constexpr std::uint8_t kMovedBy = kAbsolute | kRavenPositionRelative;
  Asked asked{desired};
  const auto correction = [&] { return (command(kLeft).p - desired.p).norm(); };
  sendUntilCorrected({asked, Asked{rest}});
  ASSERT_NEAR(correction(), 0.05, 1e-9);

  // The position stays absolute, the orientation becomes an increment: nothing jumps, neither
  // there...
  asked.option = kTurnedBy;
  asked.pose.q.setIdentity();
  double last = correction();
  for (int i = 0; i < 50; ++i) {
    send({asked, Asked{rest}});
    EXPECT_NEAR(correction(), std::max(0.0, last - kTranslationRate * kPeriod), kStampResolution);
    EXPECT_EQ(statuses_[kLeft].back().command.orientation,
              statuses_[kLeft].back().desired.orientation);
    last = correction();
  }
  EXPECT_EQ(statuses_[kLeft].back().command, statuses_[kLeft].back().desired);
  EXPECT_EQ(code(kLeft), CorrectionStatus::PASSED_NOT_ABSOLUTE);
  // ... nor back.
  asked = Asked{desired};
  send({asked, Asked{rest}});
  EXPECT_LE(correction(), kStep);
  sendUntilCorrected({asked, Asked{rest}});

  // Increments are added to what the controller was sent, the correction included: it stays in
  // force.
  asked.option = kMovedBy;
  asked.pose.p.setZero();
  for (int i = 0; i < 50; ++i) {
    send({asked, Asked{rest}});
    EXPECT_EQ(statuses_[kLeft].back().command, statuses_[kLeft].back().desired);
    EXPECT_EQ(code(kLeft), CorrectionStatus::PASSED_NOT_ABSOLUTE);
  }
  asked = Asked{desired};
  send({asked, Asked{rest}});
  EXPECT_NEAR(correction(), 0.05, 1e-9);
  EXPECT_EQ(code(kLeft), CorrectionStatus::RIGID_ONLY);

  // An orientation that was absolute all the time is known: a position alone is corrected at once.
  asked.option = kRavenPositionEnabled;
  asked.pose.q = {0.0, 1.0, 0.0, 0.0};  // not asked for: of no meaning, and not sent
  send({asked, Asked{rest}});
  EXPECT_EQ(code(kLeft), CorrectionStatus::RIGID_ONLY);
  EXPECT_EQ(statuses_[kLeft].back().command.orientation,
            statuses_[kLeft].back().desired.orientation);
  asked.pose.q = desired.q;
  asked.option = kMovedBy;
  asked.pose.p.setZero();
  send({asked, Asked{rest}});
  asked = Asked{desired, kRavenPositionEnabled};
  send({asked, Asked{rest}});
  EXPECT_EQ(code(kLeft), CorrectionStatus::RIGID_ONLY);
  EXPECT_NEAR(correction(), 0.05, 1e-9);
}

}  // namespace
}  // namespace raven_correction

int main(int argc, char** argv) {
  return raven_correction::runNodeTests(argc, argv, "test_corrector_two_arms");
}
