// SPDX-License-Identifier: BSD-3-Clause
#include "raven_correction/geometry/rotation.h"

#include <gtest/gtest.h>

#include "raven_correction/error.h"
#include "raven_correction/geometry/pose.h"
#include "support/random_poses.h"

namespace raven_correction {
namespace {

TEST(Rotation, LogUndoesExpAtEveryLength) {
  std::mt19937_64 random(1);
  for (const double angle : {0.0, 1e-300, 1e-12, 1e-9, 1e-6, 1e-3, 1.001e-3, 0.5, 3.0, M_PI - 1e-6,
                             M_PI - 1e-9, M_PI - 1e-12}) {
    for (int i = 0; i < 50; ++i) {
      const Eigen::Vector3d r = angle * randomVector(random, 1.0).normalized();
      EXPECT_LE((logRotation(expRotation(r)) - r).norm(), 4e-15 * (1.0 + angle)) << angle;
    }
  }
}

TEST(Rotation, ExpUndoesLogForEitherSignOfTheQuaternion) {
  std::mt19937_64 random(2);
  for (int i = 0; i < 1000; ++i) {
    const Eigen::Quaterniond q = randomRotation(random);
    const Eigen::Quaterniond minus(-q.w(), -q.x(), -q.y(), -q.z());
    EXPECT_LT(rotationAngle(expRotation(logRotation(q)), q), 2e-15);
    EXPECT_LT((logRotation(q) - logRotation(minus)).norm(), 1e-14);
    EXPECT_LE(logRotation(q).norm(), M_PI + 1e-15);
  }
}

TEST(Rotation, HalfTurnGivesAVectorOfLengthPi) {
  const Eigen::Quaterniond q(0.0, 0.6, 0.0, 0.8);
  EXPECT_NEAR(logRotation(q).norm(), M_PI, 1e-15);
  EXPECT_LT(rotationAngle(expRotation(logRotation(q)), q), 1e-15);
}

TEST(Rotation, ZyxAnglesBuildTheMatrixBack) {
  std::mt19937_64 random(3);
  const auto build = [](const Eigen::Vector3d& a) {
    return (Eigen::AngleAxisd(a(0), Eigen::Vector3d::UnitZ()) *
            Eigen::AngleAxisd(a(1), Eigen::Vector3d::UnitY()) *
            Eigen::AngleAxisd(a(2), Eigen::Vector3d::UnitX()))
        .toRotationMatrix();
  };
  for (int i = 0; i < 500; ++i) {
    const Eigen::Matrix3d R = randomRotation(random).toRotationMatrix();
    EXPECT_LT((build(zyxAngles(R)) - R).norm(), 1e-14);
  }
  const Eigen::Matrix3d lock = build({0.3, M_PI / 2.0, 0.1});
  EXPECT_LT((build(zyxAngles(lock)) - lock).norm(), 1e-7);
}

TEST(Rotation, NearestRotationIsNeverAMirrorImage) {
  std::mt19937_64 random(4);
  for (int i = 0; i < 200; ++i) {
    Eigen::Matrix3d M = randomRotation(random).toRotationMatrix();
    M.col(2) *= -1.0;  // the nearest orthogonal matrix is M itself, a mirror
    const Eigen::Matrix3d R = nearestRotation(M);
    EXPECT_NEAR(R.determinant(), 1.0, 1e-14);
    EXPECT_LT((R * R.transpose() - Eigen::Matrix3d::Identity()).norm(), 1e-14);
  }
}

TEST(Rotation, MeanOfRotationsAboutACentreIsTheCentre) {
  std::mt19937_64 random(5);
  const Eigen::Quaterniond centre = randomRotation(random);
  std::vector<Eigen::Quaterniond> rotations;
  for (int i = 0; i < 50; ++i) {
    const Eigen::Vector3d r = randomVector(random, 0.3);
    rotations.push_back(centre * expRotation(r));
    rotations.push_back(centre * expRotation(-r));
  }
  EXPECT_LT(rotationAngle(meanRotation(rotations), centre), 1e-14);
  EXPECT_THROW(meanRotation({}), InvalidInput);
}

TEST(Pose, CompositionAndInverseFollowTheFrames) {
  std::mt19937_64 random(6);
  for (int i = 0; i < 100; ++i) {
    const Pose X_a_b = randomPose(random), X_b_c = randomPose(random);
    const Eigen::Vector3d p_c = randomVector(random, 1.0);
    EXPECT_LT(((X_a_b * X_b_c) * p_c - X_a_b * (X_b_c * p_c)).norm(), 1e-14);
    EXPECT_LT((X_a_b.inverse() * (X_a_b * p_c) - p_c).norm(), 1e-14);
  }
}

TEST(Pose, InterpolationIsExactForConstantTwistAndTakesTheShortWay) {
  std::mt19937_64 random(7);
  for (int i = 0; i < 100; ++i) {
    const Pose a = randomPose(random);
    const Eigen::Vector3d r = randomVector(random, 0.8), v = randomVector(random, 0.1);
    Pose b{a.p + v, a.q * expRotation(r)};
    b.q.coeffs() *= -1.0;  // the same rotation, the other sign
    if (r.norm() >= M_PI) continue;
    const Pose middle = interpolate(a, b, 0.3);
    EXPECT_LT((middle.p - (a.p + 0.3 * v)).norm(), 1e-15);
    EXPECT_LT(rotationAngle(middle.q, a.q * expRotation(0.3 * r)), 1e-14);
  }
}

TEST(Pose, OnlyTheExactIdentityIsIdentity) {
  EXPECT_TRUE(isIdentity(Pose()));
  EXPECT_TRUE(isIdentity({{0, 0, 0}, {-1, 0, 0, 0}}));
  EXPECT_FALSE(isIdentity({{0, 0, 1e-12}, {1, 0, 0, 0}}));
  Pose broken;
  broken.q.w() = std::nan("");
  EXPECT_FALSE(isFinite(broken));
  EXPECT_FALSE(hasUnitQuaternion(broken));
}

}  // namespace
}  // namespace raven_correction
