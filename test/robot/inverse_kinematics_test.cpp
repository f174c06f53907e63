// SPDX-License-Identifier: BSD-3-Clause
// Inverse kinematics: round trips over the limits, branches, and what it says where it cannot.
#include "raven_correction/robot/inverse_kinematics.h"

#include <gtest/gtest.h>

#include <chrono>
#include <cmath>

#include "raven_correction/geometry/statistics.h"
#include "robot/robots.h"

namespace raven_correction {
namespace {

constexpr double kPi = 3.14159265358979323846;

/// How far the pitch axis is from the remote centre, and the wrist from straight: > 0 is regular.
bool isRegular(const KinematicChain& chain, const JointVector& q) {
  Jacobian J;
  chain.forward(q, J);
  Eigen::Matrix<double, 6, 6> scaled = J;
  scaled.topRows<3>() /= 0.05;
  return 1.0 / scaled.inverse().norm() > 0.05;
}

TEST(InverseKinematics, RoundTripInsideTheLimits) {
  for (const std::string& name : shippedRobots()) {
    const KinematicChain chain = shippedRobot(name);
    const InverseKinematics ik(chain);
    ASSERT_TRUE(ik.isClosedForm()) << name;
    std::mt19937_64 random(3);
    std::uniform_real_distribution<double> nudge(-0.01, 0.01);
    const int poses = name == "psm" ? 20000 : 100000;
    int tested = 0;
    double worst = 0.0;
    while (tested < poses) {
      const JointVector q = randomJoints(chain, random);
      if (!isRegular(chain, q)) continue;
      JointVector seed = q;
      for (int i = 0; i < 6; ++i) seed(i) += nudge(random);
      const IkResult result = ik.solve(chain.forward(q), seed);
      ASSERT_EQ(result.status, IkStatus::kOk) << name << " " << q.transpose();
      worst = std::max(worst, (result.joints - q).cwiseAbs().maxCoeff());
      ++tested;
    }
    EXPECT_LT(worst, 1e-9) << name;
  }
}

// A Raven pose has one solution inside the limits apart from a turn of the roll: any seed finds it.
TEST(InverseKinematics, AnySeedFindsTheRavenSolution) {
  for (const char* name : {"raven2_left", "raven2_right", "raven2_gold", "raven2_green"}) {
    const KinematicChain chain = shippedRobot(name);
    const InverseKinematics ik(chain);
    const int roll = chain.indexOf("tool_roll");
    std::mt19937_64 random(4);
    for (int trial = 0; trial < 5000; ++trial) {
      JointVector q = randomJoints(chain, random);
      // On the outer side of the remote centre (Berkeley 0, UW 0.47) a mirrored arm fits as well.
      const int insertion = chain.indexOf("insertion");
      const double centre = chain.home()(insertion) < 0.0 ? 0.0 : 0.47;
      if (q(insertion) > centre - 0.02 || !isRegular(chain, q)) continue;
      const IkResult result = ik.solve(chain.forward(q), randomJoints(chain, random));
      ASSERT_EQ(result.status, IkStatus::kOk) << name;
      JointVector difference = result.joints - q;
      difference(roll) -= 2.0 * kPi * std::round(difference(roll) / (2.0 * kPi));
      EXPECT_LT(difference.cwiseAbs().maxCoeff(), 1e-9) << name;
    }
  }
}

TEST(InverseKinematics, RollBeyondHalfATurnFollowsTheSeed) {
  const KinematicChain chain = shippedRobot("raven2_left");
  const InverseKinematics ik(chain);
  const int roll = chain.indexOf("tool_roll");
  JointVector q = chain.home();
  q(chain.indexOf("insertion")) = -0.12;
  for (const double angle : {181.0, -181.0, 179.0, -179.0}) {
    q(roll) = angle * kPi / 180.0;
    const IkResult result = ik.solve(chain.forward(q), q);
    EXPECT_EQ(result.status, IkStatus::kOk);
    EXPECT_NEAR(result.joints(roll), q(roll), 1e-9);
  }
  // 183 deg is beyond the limit of 182: the turn that the limits allow is taken.
  q(roll) = 183.0 * kPi / 180.0;
  const IkResult result = ik.solve(chain.forward(q), q);
  EXPECT_EQ(result.status, IkStatus::kOk);
  EXPECT_NEAR(result.joints(roll), -177.0 * kPi / 180.0, 1e-9);
}

TEST(InverseKinematics, OutsideTheLimitsStillReproducesThePose) {
  const KinematicChain chain = shippedRobot("raven2_left");
  const InverseKinematics ik(chain);
  JointVector q = chain.home();
  q(chain.indexOf("insertion")) = -0.12;
  q(chain.indexOf("shoulder")) = chain.upper()(chain.indexOf("shoulder")) + 0.1;
  const IkResult result = ik.solve(chain.forward(q), q);
  EXPECT_EQ(result.status, IkStatus::kOutsideLimits);
  EXPECT_LT((result.joints - q).cwiseAbs().maxCoeff(), 1e-9);
}

TEST(InverseKinematics, UnreachablePosesReturnTheSeed) {
  const KinematicChain chain = shippedRobot("raven2_left");
  const InverseKinematics ik(chain);
  const JointVector seed = chain.home();
  // Along the shoulder axis no elbow angle points the shaft: 52 deg and 75 deg do not meet at 0.
  Pose X = chain.forward(seed);
  X.p = chain.baseTransform() * Eigen::Vector3d(0.0, 0.0, -0.2);
  const IkResult result = ik.solve(X, seed);
  EXPECT_EQ(result.status, IkStatus::kUnreachable);
  EXPECT_TRUE(result.joints == seed);
}

TEST(InverseKinematics, SingularitiesHaveAStatus) {
  const KinematicChain chain = shippedRobot("raven2_left");
  const InverseKinematics ik(chain);
  std::mt19937_64 random(5);
  const int insertion = chain.indexOf("insertion");
  const int pitch = chain.indexOf("wrist_pitch");
  for (const double distance : {0.0, 1e-12, 1e-9, 1e-6, 1e-4}) {
    for (int trial = 0; trial < 200; ++trial) {
      JointVector q = randomJoints(chain, random);
      q(insertion) = -distance;
      const IkResult at_centre = ik.solve(chain.forward(q), q);
      EXPECT_TRUE(at_centre.joints.allFinite());
      EXPECT_NE(at_centre.status, IkStatus::kOk) << distance;
      q = randomJoints(chain, random);
      q(pitch) = kPi / 2.0 - distance;
      const IkResult straight = ik.solve(chain.forward(q), q);
      EXPECT_TRUE(straight.joints.allFinite());
    }
  }
}

// The tool roll of a Raven has 364 degrees: a pose beyond its end is inside it a turn away.
TEST(InverseKinematics, TheNearestOfAllMayLieOutsideTheLimits) {
  const KinematicChain chain = shippedRobot("raven2_left");
  IkOptions options;
  options.inside_first = false;
  const int roll = chain.indexOf("tool_roll");
  JointVector q = chain.home(), seed = chain.home();
  q(roll) = chain.upper()(roll) + 0.05;
  seed(roll) = chain.upper()(roll) - 0.05;
  const Pose X = chain.forward(q);
  const IkResult nearest = InverseKinematics(chain, options).solve(X, seed);
  EXPECT_EQ(nearest.status, IkStatus::kOutsideLimits);
  EXPECT_LT((nearest.joints - q).norm(), 1e-9);
  const IkResult inside = InverseKinematics(chain).solve(X, seed);
  EXPECT_EQ(inside.status, IkStatus::kOk);
  EXPECT_NEAR(inside.joints(roll), q(roll) - 2.0 * 3.14159265358979323846, 1e-9);
}

TEST(InverseKinematics, InvalidInputIsRefused) {
  const KinematicChain chain = shippedRobot("raven2_left");
  const InverseKinematics ik(chain);
  const Pose good = chain.forward(chain.home());
  Pose bad = good;
  bad.p.x() = std::nan("");
  EXPECT_EQ(ik.solve(bad, chain.home()).status, IkStatus::kInvalidInput);
  bad = good;
  bad.q.coeffs() *= 1.1;
  EXPECT_EQ(ik.solve(bad, chain.home()).status, IkStatus::kInvalidInput);
  EXPECT_EQ(ik.solve(good, JointVector::Zero(5)).status, IkStatus::kInvalidInput);
  JointVector seed = chain.home();
  seed(0) = std::nan("");
  EXPECT_EQ(ik.solve(good, seed).status, IkStatus::kInvalidInput);
}

// A link length where the closed form wants none: the iteration takes over.
TEST(InverseKinematics, OtherChainsAreIterated) {
  const KinematicChain raven = shippedRobot("raven2_left");
  std::vector<Joint> joints = raven.joints();
  joints[1].a = 0.01;
  const KinematicChain chain("bent", "base", raven.baseTransform(), joints, raven.toolTransform());
  const InverseKinematics ik(chain);
  ASSERT_FALSE(ik.isClosedForm());
  std::mt19937_64 random(6);
  for (int trial = 0; trial < 300; ++trial) {
    const JointVector q = randomJoints(chain, random, 0.05);
    if (!isRegular(chain, q)) continue;
    const JointVector seed = q + 0.02 * JointVector::Ones(6).cwiseProduct(q.cwiseAbs());
    const Pose X = chain.forward(q);
    const IkResult result = ik.solve(X, chain.clamp(seed));
    ASSERT_TRUE(reproducesPose(result.status)) << toString(result.status);
    const Pose back = chain.forward(result.joints);
    EXPECT_LT((back.p - X.p).norm(), 1e-9);
    EXPECT_LT(rotationAngle(back.q, X.q), 1e-9);
  }
  Pose far = chain.forward(chain.home());
  far.p = chain.baseTransform() * Eigen::Vector3d(0.0, 0.0, -0.2);  // along the shoulder axis
  EXPECT_EQ(ik.solve(far, chain.home()).status, IkStatus::kUnreachable);
}

// Not a limit on time, which depends on the machine, but on time in forward kinematics.
TEST(InverseKinematics, CostsAFewForwardKinematics) {
  using Clock = std::chrono::steady_clock;
  const KinematicChain chain = shippedRobot("raven2_left");
  const InverseKinematics ik(chain);
  std::mt19937_64 random(7);
  constexpr std::size_t kBatch = 20;  // short, so that most batches run without interruption
  std::vector<double> inverse_times;
  std::vector<double> forward_times;
  double sink = 0.0;
  for (int round = 0; round < 500; ++round) {
    std::vector<JointVector> joints;
    std::vector<Pose> poses;
    for (std::size_t i = 0; i < kBatch; ++i) {
      joints.push_back(randomJoints(chain, random));
      poses.push_back(chain.forward(joints.back()));
    }
    const auto t0 = Clock::now();
    for (std::size_t i = 0; i < kBatch; ++i) sink += ik.solve(poses[i], joints[i]).joints(0);
    const auto t1 = Clock::now();
    for (const JointVector& q : joints) sink += chain.forward(q).p.x();
    const auto t2 = Clock::now();
    inverse_times.push_back(std::chrono::duration<double, std::micro>(t1 - t0).count() / kBatch);
    forward_times.push_back(std::chrono::duration<double, std::micro>(t2 - t1).count() / kBatch);
  }
  EXPECT_TRUE(std::isfinite(sink));
  RecordProperty("inverse_ns", static_cast<int>(1000.0 * median(inverse_times)));
  RecordProperty("forward_ns", static_cast<int>(1000.0 * median(forward_times)));
  std::printf("inverse %.2f us, forward %.2f us\n", median(inverse_times), median(forward_times));
  EXPECT_LT(median(inverse_times), 25.0 * median(forward_times));
}

}  // namespace
}  // namespace raven_correction
