// SPDX-License-Identifier: BSD-3-Clause
// The corrector under simulated time that jumps: as when a bag is played in a loop, or a simulation
// starts again.
#include <gtest/gtest.h>
#include <rosgraph_msgs/Clock.h>

#include "raven_correction/ros/homing_watch.h"
#include "support/corrector_probe.h"
#include "support/node_main.h"
#include "support/operating_state.h"
#include "support/simple_model.h"

namespace raven_correction {
namespace {

const Pose kInside{{0.01, 0.01, -0.01}, expRotation({0.02, 0.0, 0.01})};

class CorrectorClock : public ::testing::Test {
 protected:
  explicit CorrectorClock(const std::string& ns = "arm")
      : probe_(ns), clock_(probe_.nh.advertise<rosgraph_msgs::Clock>("/clock", 1)) {}

  /// Sets the clock for everybody: until a pose with that stamp is not refused for its age.
  CorrectionStatus sendAt(double time) {
    rosgraph_msgs::Clock now;
    now.clock.fromSec(time);
    CorrectionStatus status;
    double stamp = time;  // of every attempt another: a repetition would be dropped
    EXPECT_TRUE(probe_.until([&] {
      clock_.publish(now);
      if (std::abs(ros::Time::now().toSec() - time) > 1e-6) return false;
      geometry_msgs::PoseStamped message = probe_.message(kInside);
      message.header.stamp.fromSec(stamp += 1e-4);
      status = probe_.send(message);
      return status.code != CorrectionStatus::REFUSED_STALE &&
             status.code != CorrectionStatus::REFUSED_FUTURE;
    }));
    return status;
  }

  CorrectorProbe<geometry_msgs::PoseStamped> probe_;
  ros::Publisher clock_;
};

TEST_F(CorrectorClock, ClockThatJumpsBackStartsTheStreamAnew) {
  probe_.publishModel(simpleModel());
  CorrectionStatus status;
  double time = 1000.0;
  EXPECT_TRUE(probe_.until([&] {
    status = sendAt(time += 0.05);
    return status.code == CorrectionStatus::CORRECTED;
  }));
  const Pose before = poseFromMsg(status.command);
  // The loop of a bag: the same stamps once more are no repetition, and the correction goes on from
  // where it is.
  status = sendAt(500.0);
  EXPECT_EQ(status.code, CorrectionStatus::CORRECTED);
  EXPECT_LT((poseFromMsg(status.command).p - before.p).norm(), 1e-3);
  EXPECT_EQ(sendAt(500.05).code, CorrectionStatus::CORRECTED);
  // Diagnostics go on, too, although their next time was that of the clock before.
  EXPECT_TRUE(probe_.diagnosed([](const auto&) { return true; }));
}

TEST_F(CorrectorClock, ClockThatJumpsAheadAllowsNoLargerStep) {
  Correction large = simpleModel();
  large.id = "large";
  large.rigid.p.x() = 0.05;
  probe_.publishModel(large);
  CorrectionStatus status;
  double time = 2000.0;
  EXPECT_TRUE(probe_.until([&] {
    status = sendAt(time += 0.05);
    return status.code == CorrectionStatus::CORRECTED && status.model == "large";
  }));
  const auto length = [&] {
    return (poseFromMsg(status.command).p - poseFromMsg(status.desired).p).norm();
  };
  const double full = length();
  EXPECT_GT(full, 0.045);
  // Two hours of silence, of which nobody knows whether they were: one step, not all of it.
  probe_.setMode("off");
  status = sendAt(9000.0);
  EXPECT_LT(status.code, 16);
  EXPECT_LE(full - length(), 0.15 * 0.1 + 1e-7);
  EXPECT_GT(length(), 0.03);
  expectStepsWithin(probe_.statuses, 0.15, 2.0, 0.1);
}

/// Of a robot that says whether it is homed.
class HomingClock : public CorrectorClock {
 protected:
  HomingClock()
      : CorrectorClock("robot"),
        state_(probe_.nh.advertise<RawMessage<OperatingStateType>>("operating_state", 1)) {
    EXPECT_TRUE(probe_.until([this] { return state_.getNumSubscribers() == 1; }));
  }
  /// The robot is homed at this time.
  void homeAt(double time) {
    // That nothing is known of it looks like not homed.
    for (const bool homed : {true, false, true}) {
      const auto held = [&] {
        state_.publish(operatingState("ENABLED", homed));
        return sendAt(time += 0.01).code == CorrectionStatus::PASSED_ROBOT_NOT_READY;
      };
      EXPECT_TRUE(probe_.until([&] { return held() != homed; }));
    }
  }
  /// Before a simulated clock has begun its state is silent for long enough to hide a homing, of
  /// which the corrector says that nobody knows when it was.
  void beSilentBeforeTheClock() {
    state_.publish(operatingState("ENABLED", true));
    EXPECT_TRUE(probe_.until([this] {
      clock_.publish(rosgraph_msgs::Clock());
      if (!ros::Time::now().isZero()) return false;
      ros::WallDuration(1.2 * HomingWatch::kSilence).sleep();
      state_.publish(operatingState("ENABLED", true));
      return mayBeOutdated(1e9);
    }));
  }
  /// Sets the clock and publishes states, no pose, until the condition holds.
  template <typename Condition>
  bool untilStatesTell(double time, Condition condition) {
    rosgraph_msgs::Clock now;
    now.clock.fromSec(time);
    return probe_.until([&] {
      clock_.publish(now);
      state_.publish(operatingState("ENABLED", true));
      return condition();
    });
  }
  /// What is said of a model whose recording knows of a homing at this time.
  std::string said(double homed_at) {
    static int number = 0;
    Correction model = simpleModel();
    model.id = "homed_" + std::to_string(++number);
    model.homed_at = homed_at;
    probe_.publishModel(model);
    std::string message;
    EXPECT_TRUE(probe_.diagnosed([&](const auto& status) {
      message = status.message;
      for (const auto& value : status.values)
        if (value.key == "model" && value.value == model.id) return true;
      return false;
    }));
    return message;
  }
  bool isOutdated(double homed_at) {
    return said(homed_at).find("recorded the robot was homed") != std::string::npos;
  }
  bool mayBeOutdated(double homed_at) {
    return said(homed_at).find("recorded the robot may have been homed") != std::string::npos;
  }

 private:
  ros::Publisher state_;
};

TEST_F(HomingClock, AHomingAndARecordingAreComparedByTheirOwnClock) {
  homeAt(3000.0);
  EXPECT_FALSE(isOutdated(3500.0)) << "Unix time is later than both";
  EXPECT_TRUE(isOutdated(2000.0));
  // The loop of a bag: what was homed was homed before its beginning.
  sendAt(1000.0);
  EXPECT_FALSE(isOutdated(1500.0));
  homeAt(1600.0);
  EXPECT_TRUE(isOutdated(1500.0));
}

TEST_F(HomingClock, WhatWasBeforeTheClockBeganIsNotAfterAHoming) {
  beSilentBeforeTheClock();
  sendAt(2500.0);
  EXPECT_TRUE(mayBeOutdated(2000.0));
  EXPECT_FALSE(mayBeOutdated(3000.0)) << "it was before the clock, and that is at 2500 s";
  homeAt(3000.0);
  EXPECT_TRUE(isOutdated(2000.0));
  EXPECT_FALSE(mayBeOutdated(3000.0));
}

TEST_F(HomingClock, AClockThatStatesTellOfBoundsThemToo) {
  beSilentBeforeTheClock();
  EXPECT_TRUE(untilStatesTell(4000.0, [this] { return !mayBeOutdated(4100.0); }));
  sendAt(5000.0);
  EXPECT_TRUE(mayBeOutdated(3900.0));
  EXPECT_FALSE(mayBeOutdated(4100.0));
}

}  // namespace
}  // namespace raven_correction

int main(int argc, char** argv) {
  return raven_correction::runNodeTests(argc, argv, "test_corrector_clock");
}
