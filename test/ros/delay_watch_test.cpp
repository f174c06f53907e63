// SPDX-License-Identifier: BSD-3-Clause
// Is the delay that is watched the delay that is there, is a clock that is off reported, and is
// nothing reported of a session that is as the model knows it?
#include "raven_correction/ros/delay_watch.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "raven_correction/dataset/dataset_directory.h"
#include "raven_correction/dataset/speed_delay.h"
#include "raven_correction/dataset/synchronisation.h"
#include "raven_correction/error.h"
#include "raven_correction/geometry/statistics.h"
#include "raven_correction/simulation/session.h"
#include "support/test_data.h"
#include "support/wait_for.h"

namespace raven_correction {
namespace {

constexpr double kStart = 1.7e9;  // Unix time [s]
constexpr double kDelay = 0.15;   // [s]

Pose motion(double t) {
  return {{0.05 * std::sin(2.0 * t), 0.05 * std::cos(1.3 * t), 0.02 * std::sin(0.7 * t)},
          expRotation({0.1 * std::sin(t), 0.0, 0.0})};
}

/// Lets the watch begin an estimate where one is due, and take it in.
void update(DelayWatch& watch) {
  watch.update();
  EXPECT_TRUE(waitFor(
      [&] {
        if (watch.estimating()) watch.update();
        return !watch.estimating();
      },
      30.0));
}

class DelayWatchTest : public ::testing::Test {
 protected:
  /// Motion at 100 Hz, seen 120 times a second through a rigid transform with noise.
  void run(DelayWatch& watch, double duration, double clock_error, double speed = 1.0) {
    std::normal_distribution<double> noise(0.0, 1e-4);
    const Pose X_seen_base{{0.3, -0.1, 0.2}, expRotation({0.3, 0.2, -0.5})};
    const double end = time_ + duration;
    for (double next_seen = time_; time_ < end; time_ += 0.01) {
      watch.addCommand({kStart + time_, motion(speed * time_)});
      for (; next_seen < time_; next_seen += 1.0 / 120.0) {
        Pose seen = X_seen_base * motion(speed * (next_seen - kDelay));
        seen.p += Eigen::Vector3d(noise(random_), noise(random_), noise(random_));
        watch.addObservation({kStart + next_seen + clock_error, seen});
      }
      update(watch);
    }
  }

  double time_ = 0.0;
  std::mt19937_64 random_{1};
};

TEST_F(DelayWatchTest, SaysNothingWithoutAModelOrASpeedDelayInIt) {
  DelayWatch watch({});
  run(watch, 90.0, 0.0);
  EXPECT_FALSE(watch.known());
  EXPECT_TRUE(std::isnan(watch.modelDelay()));
  EXPECT_EQ(watch.message(), "");
  watch.setModel("paper", std::nan(""));  // speeds did not tell when it was trained
  run(watch, 90.0, 0.0);
  EXPECT_FALSE(watch.known());
  EXPECT_EQ(watch.message(), "");
}

TEST_F(DelayWatchTest, FindsTheDelayThatIsThereAndIsSilentWhereItIsThatOfTheModel) {
  DelayWatch watch({});
  watch.setModel("m", kDelay);
  run(watch, 90.0, 0.0);
  EXPECT_TRUE(watch.known());
  EXPECT_NEAR(watch.delay(), kDelay, 0.002);
  EXPECT_EQ(watch.message(), "");
}

TEST_F(DelayWatchTest, ReportsAClockThatIsOffAndItsReturn) {
  for (const double error : {0.05, -0.05}) {
    DelayWatch watch({});
    watch.setModel("m", kDelay);
    run(watch, 90.0, error);
    EXPECT_NEAR(watch.delay(), kDelay + error, 0.002);
    EXPECT_NE(watch.message().find(error > 0.0 ? "0.050 s more" : "0.050 s less"),
              std::string::npos)
        << watch.message();
    EXPECT_NE(watch.message().find("0.150 s in what model m was trained on"), std::string::npos);
    run(watch, 90.0, 0.0);
    EXPECT_NEAR(watch.delay(), kDelay, 0.002);
    EXPECT_EQ(watch.message(), "");
  }
}

TEST_F(DelayWatchTest, SaysAtLeastWhereTheChangeIsBeyondTheSearch) {
  for (const double error : {0.5, -0.5}) {
    DelayWatch watch({});
    watch.setModel("m", kDelay);
    run(watch, 90.0, error, 0.5);
    EXPECT_NE(watch.message().find("at least 0.200 s"), std::string::npos) << watch.message();
  }
}

TEST_F(DelayWatchTest, ForgetsWhatWasEstimatedAboutAnotherModel) {
  DelayWatch watch({});
  watch.setModel("m", kDelay - 0.1);
  run(watch, 90.0, 0.0);
  EXPECT_NE(watch.message(), "");
  watch.setModel("n", kDelay);
  EXPECT_FALSE(watch.known());
  EXPECT_EQ(watch.message(), "");
  run(watch, 40.0, 0.0);
  EXPECT_TRUE(watch.known());
  EXPECT_EQ(watch.message(), "");
}

TEST_F(DelayWatchTest, ForgetsTheStreamsAndTheAlarmWhenTheClockHasJumped) {
  DelayWatch watch({});
  watch.setModel("m", kDelay);
  run(watch, 90.0, 0.05);
  ASSERT_NE(watch.message(), "");
  watch.clear();
  EXPECT_FALSE(watch.known());
  EXPECT_EQ(watch.message(), "");
  EXPECT_EQ(watch.modelDelay(), kDelay) << "the model is the one it was";
  run(watch, 20.0, 0.0);
  EXPECT_FALSE(watch.known()) << "half of a window has to come first, of after the jump alone";
  run(watch, 40.0, 0.0);
  EXPECT_NEAR(watch.delay(), kDelay, 0.002);
  EXPECT_EQ(watch.message(), "");
}

TEST_F(DelayWatchTest, AnEstimateThatIsMadeOfForgottenStreamsIsNotTakenIn) {
  DelayWatch watch({});
  watch.setModel("m", kDelay);
  run(watch, 29.0, 0.05);
  ASSERT_FALSE(watch.known());
  for (; !watch.estimating(); time_ += 0.01) {  // as run() does, but nobody takes it in
    ASSERT_LT(time_, 60.0);
    watch.addCommand({kStart + time_, motion(time_)});
    watch.addObservation({kStart + time_ + 0.05, motion(time_ - kDelay)});
    watch.update();
  }
  watch.clear();
  update(watch);
  EXPECT_FALSE(watch.estimating());
  EXPECT_FALSE(watch.known());
  EXPECT_EQ(watch.message(), "");
}

TEST_F(DelayWatchTest, SaysNothingOfAToolAtRest) {
  DelayWatch watch({});
  watch.setModel("m", kDelay);
  run(watch, 90.0, 0.05, 0.0);
  EXPECT_FALSE(watch.known());
  EXPECT_EQ(watch.message(), "");
}

TEST(DelayWatchOptions, AreChecked) {
  EXPECT_THROW(DelayWatch({0.0, 0.03}), InvalidInput);
  EXPECT_THROW(DelayWatch({60.0, -1.0}), InvalidInput);
  EXPECT_THROW(DelayWatch({60.0, std::nan("")}), InvalidInput);
}

/// Feeds a session, with the delay of the whole of it as the model's.
struct Watched {
  std::vector<double> changes;  ///< of every estimate [s]
  std::string message;          ///< the first one
};
Watched watchSession(const Dataset& session) {
  const DelayResult model = estimateSpeedDelay(session, SpeedDelayProblem());
  DelayWatch watch({});
  // Where the whole does not tell, the watch may still believe that a minute does.
  const double delay = model.status == DelayResult::Status::kOk ? model.delay : 0.17;
  watch.setModel("whole", delay);
  PoseStream commands, observations;
  for (const Trajectory& trajectory : session.trajectories) {
    const PoseStream& c = trajectory.commands;
    commands.insert(commands.end(), c.begin(), c.end());
    for (const StampedPose& seen : screenObservations(trajectory.observations).samples)
      observations.push_back(seen);
  }
  Watched watched;
  double last = std::nan("");
  std::size_t k = 0;
  for (const StampedPose& seen : observations) {
    for (; k < commands.size() && commands[k].stamp <= seen.stamp; ++k)
      watch.addCommand(commands[k]);
    watch.addObservation(seen);
    update(watch);
    if (watched.message.empty()) watched.message = watch.message();
    if (watch.known() && watch.delay() != last) watched.changes.push_back(watch.delay() - delay);
    if (watch.known()) last = watch.delay();
  }
  return watched;
}

TEST(DelayWatchOnSessions, StaysWithinTheLimitOnASimulatedSession) {
  const Watched watched =
      watchSession(simulateSession(loadSimulationConfig("config/simulation/demo.yaml"), 60, 5));
  EXPECT_GE(watched.changes.size(), 5u);
  EXPECT_EQ(watched.message, "");
}

// The speed of this robot's tool is so unlike that of its commands (correlation 0.3 to 0.7 within a
// minute) that nothing can be said; what matters is that nothing wrong is said.
TEST(DelayWatchOnSessions, RaisesNoFalseAlarmOnTheMeasuredSession) {
  const std::string path = testData("case2014_left");
  RAVEN_SKIP_WITHOUT_DATA(path, "case2014_left");
  EXPECT_EQ(watchSession(readDatasetDirectory(path)).message, "");
}

}  // namespace
}  // namespace raven_correction
