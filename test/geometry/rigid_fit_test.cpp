// SPDX-License-Identifier: BSD-3-Clause
#include "raven_correction/geometry/rigid_fit.h"

#include <gtest/gtest.h>

#include "raven_correction/error.h"
#include "support/random_poses.h"

namespace raven_correction {
namespace {

RigidFitProblem exactProblem(const Pose& X, int n, double rotation_length, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  RigidFitProblem problem;
  problem.rotation_length = rotation_length;
  for (int i = 0; i < n; ++i) {
    problem.from.push_back(randomPose(random));
    problem.to.push_back(X * problem.from.back());
  }
  return problem;
}

TEST(RigidFit, RecoversAKnownTransformFromExactData) {
  std::mt19937_64 random(1);
  for (const double rotation_length : {0.0, 0.05, 1.0})
    for (int trial = 0; trial < 20; ++trial) {
      const Pose X = randomPose(random);
      const RigidFitResult fit =
          fitRigid(exactProblem(X, 20, rotation_length, static_cast<std::uint64_t>(trial)));
      EXPECT_EQ(fit.status, RigidFitResult::Status::kOk);
      EXPECT_LT((fit.X_b_a.p - X.p).norm(), 1e-12);
      EXPECT_LT(rotationAngle(fit.X_b_a.q, X.q), 1e-12);
      EXPECT_LT(fit.rms_position, 1e-12);
    }
}

TEST(RigidFit, OnePoseIsEnoughWhenRotationsCount) {
  std::mt19937_64 random(2);
  const Pose X = randomPose(random);
  const RigidFitResult fit = fitRigid(exactProblem(X, 1, 0.05, 3));
  EXPECT_LT((fit.X_b_a.p - X.p).norm(), 1e-12);
  EXPECT_LT(rotationAngle(fit.X_b_a.q, X.q), 1e-12);
}

TEST(RigidFit, MirroredPointsStillGiveARotation) {
  // The points lie in a plane but for noise, and the targets are their mirror image: without the
  // determinant in the closed form, the answer is a reflection.
  std::mt19937_64 random(3);
  RigidFitProblem problem;
  problem.rotation_length = 0.0;
  for (int i = 0; i < 50; ++i) {
    Pose from, to;
    from.p = randomVector(random, 0.05).cwiseProduct(Eigen::Vector3d(1.0, 1.0, 0.2));
    to.p = from.p.cwiseProduct(Eigen::Vector3d(1.0, 1.0, -1.0));
    problem.from.push_back(from);
    problem.to.push_back(to);
  }
  const RigidFitResult fit = fitRigid(problem);
  EXPECT_NEAR(fit.X_b_a.q.toRotationMatrix().determinant(), 1.0, 1e-12);
  EXPECT_GT(fit.rms_position, 1e-4);  // a mirror image cannot be reached
  // No small turn and shift may do better: it is the optimum among rotations.
  const auto cost = [&](const Pose& X) {
    double sum = 0.0;
    for (std::size_t i = 0; i < problem.from.size(); ++i)
      sum += (X * problem.from[i].p - problem.to[i].p).squaredNorm();
    return sum;
  };
  const double optimum = cost(fit.X_b_a);
  for (int i = 0; i < 200; ++i) {
    const Pose nudge{randomVector(random, 1e-4), expRotation(randomVector(random, 1e-2))};
    EXPECT_GE(cost(nudge * fit.X_b_a), optimum);
  }
}

TEST(RigidFit, PointsOnALineAreDegenerate) {
  RigidFitProblem problem;
  problem.rotation_length = 0.0;
  for (int i = 0; i < 10; ++i) problem.from.push_back({{0.01 * i, 0.0, 0.0}, {1, 0, 0, 0}});
  problem.to = problem.from;
  EXPECT_EQ(fitRigid(problem).status, RigidFitResult::Status::kDegenerate);
}

TEST(RigidFit, BadInputIsRefusedWithItsPlace) {
  RigidFitProblem problem = exactProblem(Pose(), 5, 0.05, 1);
  problem.to[3].p.y() = std::nan("");
  try {
    fitRigid(problem);
    FAIL() << "not a number was accepted";
  } catch (const InvalidInput& error) {
    EXPECT_NE(std::string(error.what()).find("pair 3"), std::string::npos) << error.what();
  }
  problem.to.pop_back();
  EXPECT_THROW(fitRigid(problem), InvalidInput);
  EXPECT_THROW(fitRigid(RigidFitProblem()), InvalidInput);
}

}  // namespace
}  // namespace raven_correction
