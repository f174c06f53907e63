// SPDX-License-Identifier: BSD-3-Clause
// Playing a motion: its stamps on a good and on a bad clock, its end when stopped, and the move
// that leads to its start.
#include "raven_correction/ros/playback.h"

#include <gtest/gtest.h>

#include <cmath>

#include "raven_correction/error.h"

namespace raven_correction {
namespace {

constexpr double kPeriod = 0.02;
constexpr double kStart = 1e6;

PoseStream lineOf(int samples, double speed) {
  PoseStream motion;
  for (int i = 0; i < samples; ++i) {
    Pose pose;
    pose.p.x() = speed * i * kPeriod;
    motion.push_back({i * kPeriod, pose});
  }
  return motion;
}

/// What is sent when the clock is read every `tick`.
PoseStream playAll(Playback& playback, double tick) {
  PoseStream sent;
  for (double now = kStart; !playback.finished() && now < kStart + 100.0; now += tick)
    while (const auto command = playback.next(now)) sent.push_back(*command);
  return sent;
}

TEST(Playback, SendsEveryCommandAtItsTime) {
  const PoseStream motion = lineOf(50, 0.1);
  for (const double tick : {1e-3, 0.012, 0.02}) {
    Playback playback(motion, kStart, kPeriod);
    const PoseStream sent = playAll(playback, tick);
    ASSERT_EQ(sent.size(), motion.size()) << tick;
    for (std::size_t i = 0; i < sent.size(); ++i) {
      EXPECT_NEAR(sent[i].stamp, kStart + motion[i].stamp, 1e-6) << tick;
      EXPECT_EQ(sent[i].pose.p, motion[i].pose.p);
    }
    EXPECT_FALSE(playback.stopping());
  }
}

TEST(Playback, SaysNothingBeforeItsTimeAndNothingAfterItsEnd) {
  Playback playback(lineOf(2, 0.1), kStart, kPeriod);
  EXPECT_FALSE(playback.next(kStart - 1e-3));
  EXPECT_TRUE(playback.next(kStart));
  EXPECT_FALSE(playback.next(kStart + 0.5 * kPeriod));
  EXPECT_TRUE(playback.next(kStart + kPeriod));
  EXPECT_TRUE(playback.finished());
  EXPECT_FALSE(playback.next(kStart + 10.0));
}

TEST(Playback, ALateCommandDelaysTheRestInsteadOfHurryingIt) {
  Playback playback(lineOf(50, 0.1), kStart, kPeriod);
  PoseStream sent;
  for (int i = 0; i < 10; ++i) sent.push_back(*playback.next(playback.due()));
  const double late = kStart + 3.0;  // the process stood still for almost three seconds
  while (const auto command = playback.next(late)) sent.push_back(*command);
  EXPECT_EQ(sent.size(), 11u) << "a burst of commands";
  EXPECT_EQ(sent.back().stamp, late);
  EXPECT_NEAR(playback.due(), late + kPeriod, 1e-6);
  for (std::size_t i = 1; i < sent.size(); ++i) {
    const double speed =
        (sent[i].pose.p - sent[i - 1].pose.p).norm() / (sent[i].stamp - sent[i - 1].stamp);
    EXPECT_LT(speed, 0.1 * (1.0 + 1e-4));
  }
}

TEST(Playback, AStopSlowsDownEvenlyAlongThePath) {
  const double speed = 0.1;
  const double duration = 0.2;
  Playback playback(lineOf(200, speed), kStart, kPeriod);
  for (int i = 0; i < 20; ++i) ASSERT_TRUE(playback.next(playback.due()));
  playback.stop(duration);
  EXPECT_TRUE(playback.stopping());
  PoseStream sent{{kStart + 19 * kPeriod, lineOf(20, speed).back().pose}};
  while (!playback.finished()) sent.push_back(*playback.next(playback.due()));

  EXPECT_EQ(sent.size(), 11u);
  // Even deceleration from v to rest in T covers v T / 2, and v falls by the same amount each time.
  EXPECT_NEAR((sent.back().pose.p - sent.front().pose.p).norm(), 0.5 * speed * duration, 1e-12);
  for (std::size_t i = 2; i < sent.size(); ++i) {
    const double before = (sent[i - 1].pose.p - sent[i - 2].pose.p).norm();
    const double after = (sent[i].pose.p - sent[i - 1].pose.p).norm();
    EXPECT_NEAR(before - after, speed * kPeriod * kPeriod / duration, 1e-12);
  }
}

TEST(Playback, AStopNearTheEndStaysOnThePathAndAStopBeforeTheStartSendsNothing) {
  const PoseStream motion = lineOf(10, 0.1);
  Playback playback(motion, kStart, kPeriod);
  for (int i = 0; i < 9; ++i) playback.next(kStart + i * kPeriod);
  playback.stop(1.0);
  Pose last;
  while (!playback.finished()) last = playback.next(playback.due())->pose;
  EXPECT_EQ(last.p, motion.back().pose.p);

  Playback unused(motion, kStart, kPeriod);
  unused.stop(1.0);
  EXPECT_TRUE(unused.finished());
  EXPECT_FALSE(unused.next(kStart));
}

TEST(Playback, RefusesWhatIsNotAMotion) {
  EXPECT_THROW(Playback({}, kStart, kPeriod), InvalidInput);
  PoseStream backwards = lineOf(3, 0.1);
  backwards[2].stamp = 0.0;
  EXPECT_THROW(Playback(backwards, kStart, kPeriod), InvalidInput);
  EXPECT_THROW(Playback(lineOf(3, 0.1), kStart, std::nan("")), InvalidInput);
}

TEST(SmoothMove, KeepsItsLimitsAndReachesBothEnds) {
  const Pose from{{-0.02, -0.05, -0.15}, Eigen::Quaterniond(0.5, 0.5, 0.5, -0.5)};
  const double period = 1e-3;
  const struct {
    Eigen::Vector3d translation;
    double angle;
  } moves[] = {{{0.06, 0.0, 0.0}, 0.1},   // limited by the speed
               {{0.001, 0.0, 0.0}, 1.5},  // by the angular speed
               {{0.002, 0.0, 0.0}, 0.0},  // by the acceleration
               {{0.0, 0.0, 0.0}, 0.0}};
  const double speed = 0.05;
  const double angular_speed = 0.5;
  const double acceleration = 0.2;
  for (const auto& move : moves) {
    const Pose to{from.p + move.translation, from.q * Eigen::Quaterniond(Eigen::AngleAxisd(
                                                          move.angle, Eigen::Vector3d::UnitY()))};
    const PoseStream motion = smoothMove(from, to, speed, angular_speed, acceleration, period);
    ASSERT_GE(motion.size(), 2u);
    EXPECT_EQ(motion.front().stamp, 0.0);
    EXPECT_LT((motion.front().pose.p - from.p).norm(), 1e-15);
    EXPECT_EQ(motion.back().pose.p, to.p);
    EXPECT_EQ(motion.back().pose.q.coeffs(), to.q.coeffs());
    double fastest = 0.0;
    double fastest_turn = 0.0;
    double hardest = 0.0;
    for (std::size_t i = 1; i < motion.size(); ++i) {
      const double v = (motion[i].pose.p - motion[i - 1].pose.p).norm() / period;
      fastest = std::max(fastest, v);
      fastest_turn =
          std::max(fastest_turn, rotationAngle(motion[i].pose.q, motion[i - 1].pose.q) / period);
      if (i + 1 < motion.size()) {
        const double next = (motion[i + 1].pose.p - motion[i].pose.p).norm() / period;
        hardest = std::max(hardest, std::abs(next - v) / period);
      }
    }
    EXPECT_LE(fastest, speed * 1.001);
    EXPECT_LE(fastest_turn, angular_speed * 1.001);
    EXPECT_LE(hardest, acceleration * 1.001);
    // And one of the limits is used: the move is not slower than it has to be.
    const double used =
        std::max({fastest / speed, fastest_turn / angular_speed, hardest / acceleration});
    if (move.translation.norm() > 0.0) {
      EXPECT_GT(used, 0.98);
    }
  }
}

TEST(SmoothMove, RefusesBadLimits) {
  EXPECT_THROW(smoothMove({}, {}, 0.0, 1.0, 1.0, 0.02), InvalidInput);
  EXPECT_THROW(smoothMove({}, {}, 1.0, 1.0, 1.0, std::nan("")), InvalidInput);
  Pose nowhere;
  nowhere.p.x() = std::nan("");
  EXPECT_THROW(smoothMove({}, nowhere, 1.0, 1.0, 1.0, 0.02), InvalidInput);
}

}  // namespace
}  // namespace raven_correction
