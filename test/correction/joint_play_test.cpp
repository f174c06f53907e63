// SPDX-License-Identifier: BSD-3-Clause
// The play of a robot's joints, as the motion of its tool tells it.
#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "raven_correction/correction/motion.h"
#include "raven_correction/correction/training.h"
#include "raven_correction/correction/training_config.h"
#include "raven_correction/error.h"
#include "raven_correction/robot/chain_file.h"

namespace raven_correction {
namespace {

const char kRobot[] = "config/robots/raven2_left.yaml";
constexpr int kJoints = 6, kInsertion = 3;  // of the Raven

MotionOptions withRobot() {
  MotionOptions options;
  options.joint_play_length = 0.003;
  options.joint_play_angle = 0.04;
  options.joint_play_wrist = 0.06;
  knowRobot(kRobot, options);
  return options;
}

/// Joints that wander about their homes and turn round often, at 50 Hz.
class Wanderer {
 public:
  explicit Wanderer(unsigned seed) : robot_(loadKinematicChain(kRobot)), random_(seed) {
    velocity_ = JointVector::Zero(kJoints);
    joints_ = robot_.home();
  }
  Pose next() {
    std::uniform_real_distribution<double> uniform(-1.0, 1.0);
    for (int j = 0; j < kJoints; ++j) {
      const double scale =
          robot_.joints()[static_cast<std::size_t>(j)].type == JointType::kPrismatic ? 0.001 : 0.01;
      if (std::abs(uniform(random_)) < 0.1) velocity_(j) = scale * uniform(random_);
      const double away = (joints_(j) - robot_.home()(j)) / (20.0 * scale);
      if (std::abs(away) > 1.0) velocity_(j) = -std::copysign(scale, away);
    }
    joints_ += velocity_;
    return robot_.forward(joints_);
  }
  const JointVector& joints() const { return joints_; }
  const KinematicChain& robot() const { return robot_; }

 private:
  KinematicChain robot_;
  std::mt19937_64 random_;
  JointVector velocity_, joints_;
};

TEST(JointPlay, IsThePlayOperatorOfEachJoint) {
  const MotionOptions options = withRobot();
  MotionEstimator estimator(options);
  Wanderer wanderer(1);
  JointVector follower = JointVector::Zero(kJoints);
  double ends = 0.0;
  for (int i = 0; i < 2000; ++i) {
    ASSERT_EQ(estimator.push(1.0 + 0.02 * i, wanderer.next()), MotionEstimator::Outcome::kAccepted);
    if (i == 0) follower = wanderer.joints();
    for (int j = 0; j < kJoints; ++j) {
      const double r = j < 2             ? options.joint_play_angle  // shoulder, elbow
                       : j == kInsertion ? options.joint_play_length
                                         : options.joint_play_wrist;
      // doi:10.1007/978-1-4612-4048-8
      follower(j) =
          std::min(wanderer.joints()(j) + r, std::max(wanderer.joints()(j) - r, follower(j)));
      const double expected = (wanderer.joints()(j) - follower(j)) / r;
      ASSERT_NEAR(estimator.motion().joint_play(j), expected, 1e-6) << i << " " << j;
      ends += std::abs(expected) > 0.999 ? 1.0 : 0.0;
    }
  }
  EXPECT_GT(ends, 1000.0);  // the wanderer does come to the ends of the play
}

TEST(JointPlay, StaysInAPauseAndAtRest) {
  MotionEstimator estimator(withRobot());
  Wanderer wanderer(2);
  Pose pose;
  for (int i = 0; i < 500; ++i) estimator.push(1.0 + 0.02 * i, pose = wanderer.next());
  const Eigen::Matrix<double, 6, 1> before = estimator.motion().joint_play;
  EXPECT_GT(before.norm(), 0.5);
  estimator.startMotion();
  for (int i = 0; i < 50; ++i) estimator.push(100.0 + 0.02 * i, pose);
  EXPECT_LT((estimator.motion().joint_play - before).norm(), 1e-6);
  estimator.reset();
  estimator.push(200.0, pose);
  EXPECT_EQ(estimator.motion().joint_play.norm(), 0.0);
}

TEST(JointPlay, APoseOutOfReachMovesNoJoint) {
  MotionEstimator estimator(withRobot());
  Wanderer wanderer(3);
  for (int i = 0; i < 500; ++i) estimator.push(1.0 + 0.02 * i, wanderer.next());
  const Eigen::Matrix<double, 6, 1> before = estimator.motion().joint_play;
  Pose far;
  far.p << 30.0, 0.0, 0.0;
  estimator.push(50.0, far);
  EXPECT_EQ(estimator.motion().joint_play, before);
}

TEST(JointPlay, ASampleThatIsTakenBackLeavesNoTrace) {
  MotionEstimator disturbed(withRobot()), undisturbed(withRobot());
  Wanderer wanderer(4), other(5);
  for (int i = 0; i < 500; ++i) {
    const double t = 1.0 + 0.02 * i;
    if (i % 3 == 0) {
      disturbed.push(t, other.next());
      disturbed.undo();
    }
    const Pose pose = wanderer.next();
    disturbed.push(t, pose);
    undisturbed.push(t, pose);
    ASSERT_EQ(disturbed.motion().joint_play, undisturbed.motion().joint_play) << i;
  }
}

TEST(JointPlay, OneThatTakesOverKnowsWhatTheOtherKnew) {
  MotionOptions blind;  // what follows before there is a model
  blind.velocity = VelocityKind::kNone;
  blind.window = 1.0;
  blind.max_gap = 10.0;
  MotionOptions wider = withRobot();
  wider.joint_play_angle = 0.05;
  MotionEstimator without(blind), other_width(wider), same(withRobot()), all_along(withRobot());
  Wanderer wanderer(6);
  double t = 1.0;
  for (int i = 0; i < 100; ++i, t += 0.02) {
    const Pose pose = wanderer.next();
    for (MotionEstimator* estimator : {&without, &other_width, &same, &all_along})
      estimator->push(t, pose);
  }
  const Pose pose = wanderer.next();
  all_along.push(t, pose);
  const Eigen::Matrix<double, 6, 1> expected = all_along.motion().joint_play;
  EXPECT_GT(expected.norm(), 0.5);
  for (MotionEstimator* before : {&without, &same, &other_width}) {
    MotionEstimator late(withRobot());
    late.takeOver(*before);
    late.push(t, pose);
    EXPECT_LT((late.motion().joint_play - expected).norm(), 1e-9);
  }
}

// LEDs that are taken for one another turn the tool for a moment: what is learnt after it must not
// have the joints on the wrong side of their play.
TEST(JointPlay, OutliersOfTheTrainingDoNotDragIt) {
  constexpr std::size_t kSamples = 300, kFirst = 100, kLast = 110;
  const MotionOptions options = withRobot();
  Wanderer wanderer(5);
  TrainingPairs pairs;
  PoseStream right;
  for (std::size_t i = 0; i < kSamples; ++i)
    right.push_back({100.0 + 0.02 * static_cast<double>(i), wanderer.next()});
  const std::vector<Motion> expected = motionsOf(right, options);
  PoseStream seen = right;
  std::vector<Fate> fates(kSamples, Fate::kKept);
  for (std::size_t i = kFirst; i < kLast; ++i) {
    seen[i].pose.p += Eigen::Vector3d(0.02, -0.02, 0.01);
    seen[i].pose.q = seen[i].pose.q * expRotation({0.3, -0.3, 0.3});
    fates[i] = Fate::kLeastMedian;
  }
  pairs.observations = {seen};
  pairs.motions = motionsOf(seen, options);
  for (std::size_t i = 0; i < kSamples; ++i) {
    pairs.samples.push_back({0, seen[i].pose, seen[i].pose, {}, 0.02});
    pairs.rows.push_back(i);
  }
  const auto off = [&](std::size_t i) {
    return (pairs.motions[i].joint_play - expected[i].joint_play).cwiseAbs().maxCoeff();
  };
  EXPECT_GT(off(kLast), 0.5);
  followPlayWithoutOutliers(pairs, fates, options);
  for (std::size_t i = 0; i < kFirst; ++i) EXPECT_LT(off(i), 1e-12) << i;
  // What was not seen meanwhile counts as a straight move, for as long as it takes to move again.
  for (std::size_t i = kLast + 10; i < kSamples; ++i) EXPECT_LT(off(i), 0.3) << i;
  EXPECT_LT(off(kSamples - 1), 0.1);
  // What a motion was before and after is not changed.
  for (std::size_t i = 0; i < kSamples; ++i) EXPECT_EQ(pairs.motions[i].pose.p, seen[i].pose.p);
}

TEST(JointPlay, RefusesARobotThatItCannotFollow) {
  MotionOptions options;
  options.robot = "name: nothing";
  EXPECT_THROW(MotionEstimator{options}, InvalidInput);
  options = withRobot();
  options.joint_play_angle = 0.0;
  EXPECT_THROW(MotionEstimator{options}, InvalidInput);
  options = withRobot();
  options.joint_play_wrist = 4.0;
  EXPECT_THROW(MotionEstimator{options}, InvalidInput);
  EXPECT_THROW(knowRobot("config/robots/no_such_robot.yaml", options), InvalidInput);
}

}  // namespace
}  // namespace raven_correction
