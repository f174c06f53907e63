// SPDX-License-Identifier: BSD-3-Clause
#include "raven_correction/correction/predictor.h"

#include <gtest/gtest.h>

#include "raven_correction/error.h"
#include "support/simple_model.h"

namespace raven_correction {
namespace {

TEST(Correction, ApplyUndoesBetween) {
  std::mt19937_64 random(1);
  for (int i = 0; i < 100; ++i) {
    const Pose a = randomPose(random), b = randomPose(random);
    const Pose back = applyCorrection(a, correctionBetween(a, b));
    EXPECT_LT((back.p - b.p).norm(), 1e-14);
    EXPECT_LT(rotationAngle(back.q, b.q), 1e-13);
  }
}

TEST(Correction, FeaturesAreThePoseTheTwistsAndThePlayAfterTheRigidStep) {
  std::mt19937_64 random(4);
  const Pose rigid = randomPose(random);
  const Eigen::Quaterniond mean = randomPose(random).q;
  MotionOptions options;
  options.intervals = {0.05, 0.15};
  Motion motion;
  motion.pose = randomPose(random);
  for (std::size_t k = 0; k < 2; ++k)
    motion.twists[k] = {randomVector(random, 0.1), randomVector(random, 1.0)};
  motion.play = {randomVector(random, 0.02), randomVector(random, 0.3)};
  const auto features = [&] {
    Eigen::VectorXd x = Eigen::VectorXd::Constant(kMaxFeatures + 1, -7.0);
    computeFeatures(motion, rigid, mean, options, x.data());
    EXPECT_EQ(x(static_cast<Eigen::Index>(featureCount(options))), -7.0) << "written beyond";
    return Eigen::VectorXd(x.head(static_cast<Eigen::Index>(featureCount(options))));
  };
  ASSERT_EQ(features().size(), 18);
  options.play_length = 0.02;
  options.play_angle = 0.3;
  const Eigen::VectorXd x = features();
  ASSERT_EQ(x.size(), 24);
  EXPECT_LT((x.head<3>() - rigid * motion.pose.p).norm(), 1e-15);
  EXPECT_LT((x.segment<3>(12) - rigid.q * motion.twists[1].v).norm(), 1e-15);
  EXPECT_LT((x.segment<3>(18) - rigid.q * motion.play.p).norm(), 1e-15);
  EXPECT_LT((x.segment<3>(21) - rigid.q * motion.play.r).norm(), 1e-15);
  // Joints are the same seen from anywhere.
  options.robot = "a robot";
  motion.joint_play << -1.0, -0.5, 0.0, 0.25, 0.75, 1.0;
  EXPECT_EQ(features().tail<6>(), motion.joint_play);
}

TEST(Predictor, ReproducesTheFieldAtFreshPoses) {
  const Correction model = simpleModel();
  const Predictor predictor(model);
  const auto workspace = predictor.makeWorkspace();
  std::mt19937_64 random(2);
  std::uniform_real_distribution<double> uniform(-0.04, 0.04);
  for (int i = 0; i < 100; ++i) {
    Motion motion;
    motion.pose = {{uniform(random), uniform(random), uniform(random)},
                   expRotation(randomVector(random, 0.05))};
    const Prediction prediction = predictor.predict(motion, *workspace);
    const Pose after = model.rigid * motion.pose;
    const Pose truth = applyCorrection(after, fieldAt(after));
    // The field is up to 4 mm and 0.05 rad; a smooth field is learnt to a few percent of it.
    EXPECT_LT((prediction.command.p - truth.p).norm(), 4e-4);
    EXPECT_LT(rotationAngle(prediction.command.q, truth.q), 5e-3);
    EXPECT_EQ(prediction.status, Prediction::Status::kFull);
  }
}

TEST(Predictor, FadesContinuouslyAlongAPathOutOfTheWorkspace) {
  const Predictor predictor(simpleModel());
  const auto workspace = predictor.makeWorkspace();
  Pose last;
  for (int i = 0; i <= 2000; ++i) {
    Motion motion;
    motion.pose.p = {1e-4 * i, 0.0, 0.0};
    const Prediction prediction = predictor.predict(motion, *workspace);
    if (i > 0) {
      EXPECT_LT((prediction.command.p - last.p).norm(), 1.5e-3) << i;
    }
    last = prediction.command;
    if (i == 2000) {
      EXPECT_EQ(prediction.status, Prediction::Status::kOutside);
      EXPECT_EQ(prediction.command.p, motion.pose.p);
      EXPECT_EQ(prediction.g_share, 0.0);
    }
  }
}

TEST(Predictor, RefusesAModelThatDoesNotFitTogether) {
  Correction model = simpleModel();
  model.motion.velocity = VelocityKind::kNone;  // 6 features, the process has 12
  EXPECT_THROW(Predictor{model}, InvalidInput);
  model = simpleModel();
  model.rigid.p.x() = std::nan("");
  EXPECT_THROW(Predictor{model}, InvalidInput);
  model = simpleModel();
  model.trust.fade_end = model.trust.fade_start;
  EXPECT_THROW(Predictor{model}, InvalidInput);
}

}  // namespace
}  // namespace raven_correction
