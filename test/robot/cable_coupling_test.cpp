// SPDX-License-Identifier: BSD-3-Clause
// Motor angles against the published matrices, round trips, and the size of one encoder count.
#include "raven_correction/robot/cable_coupling.h"

#include <gtest/gtest.h>

#include <cmath>

#include "raven_correction/error.h"
#include "robot/robots.h"

namespace raven_correction {
namespace {

CableCoupling shippedCoupling(const std::string& name) {
  return loadCableCoupling("config/robots/" + name + ".yaml");
}

// The matrix of the gold arm as computed from the published constants, three decimals.
TEST(CableCoupling, GoldMatrix) {
  Eigen::Matrix<double, 7, 7> expected;
  expected << 136.196, 0, 0, 0, 0, 0, 0,     //
      17.675, 121.522, 0, 0, 0, 0, 0,        //
      16.831, 17.436, 2158.59, 0, 0, 0, 0,   //
      5.787, 5.994, 742.12, 5.395, 0, 0, 0,  //
      5.787, 5.994, 742.12, 0, 8.992, 0, 0,  //
      5.787, 5.994, 742.12, 0, 0, 8.992, 0,  //
      5.787, 5.994, 742.12, 0, 0, 0, 8.992;
  const CableCoupling gold = shippedCoupling("raven2_gold");
  for (int j = 0; j < 7; ++j) {
    const Eigen::VectorXd m = gold.motorsFromJoints(Eigen::VectorXd::Unit(7, j));
    for (int i = 0; i < 7; ++i) EXPECT_NEAR(m(i), expected(i, j), j == 2 ? 0.02 : 6e-4);
  }
}

// The published Berkeley equations from motors to joints, written out.
TEST(CableCoupling, BerkeleyEquations) {
  const CableCoupling left = shippedCoupling("raven2_left");
  const Eigen::VectorXd m = (Eigen::VectorXd(7) << 60, 150, -240, 3, -2, 4, 5).finished();
  const Eigen::VectorXd q = left.jointsFromMotors(m);
  EXPECT_NEAR(q(0), 0.00791795 * m(0), 1e-8);
  EXPECT_NEAR(q(1), 0.00887407 * m(1) - 0.145567 * q(0), 1e-8);
  EXPECT_NEAR(q(2), 0.000461942 * m(2) - 0.007905 * q(1) - 0.007905 * q(0), 1e-8);
  EXPECT_NEAR(q(3), 0.186938 * m(3) - 138.196 * q(2) - 1.09244 * (q(1) + q(0)), 1e-6);
  EXPECT_NEAR(q(4), 0.124997 * m(4) - 92.4055 * q(2) - 0.730466 * (q(1) + q(0)), 1e-6);
  EXPECT_NEAR(q(5), 0.113011 * m(5) - 83.5447 * q(2) - 0.660421 * (q(1) + q(0)), 1e-6);
}

TEST(CableCoupling, RoundTrip) {
  std::mt19937_64 random(9);
  std::normal_distribution<double> normal;
  for (const char* name : {"raven2_left", "raven2_right", "raven2_gold", "raven2_green"}) {
    const CableCoupling coupling = shippedCoupling(name);
    for (int trial = 0; trial < 100; ++trial) {
      Eigen::VectorXd q(7);
      for (int j = 0; j < 7; ++j) q(j) = normal(random);
      const Eigen::VectorXd back = coupling.jointsFromMotors(coupling.motorsFromJoints(q));
      EXPECT_LT((back - q).cwiseAbs().maxCoeff(), 1e-11) << name;
    }
  }
  EXPECT_TRUE(shippedCoupling("psm").empty());
}

// The published Berkeley ratios: what a motor turns, in units of its joint, when other joints move.
TEST(CableCoupling, MotorTravelInJointUnits) {
  const KinematicChain chain = shippedRobot("raven2_left");
  const JointMatrix travel = shippedCoupling("raven2_left").motorTravel(chain);
  const auto at = [&](const char* motor, const char* joint) {
    return travel(chain.indexOf(motor), chain.indexOf(joint));
  };
  for (int j = 0; j < 6; ++j) EXPECT_NEAR(travel(j, j), 1.0, 1e-12);
  EXPECT_NEAR(at("elbow", "shoulder"), 0.145567, 1e-6);
  EXPECT_NEAR(at("insertion", "elbow"), 0.007905, 1e-6);
  EXPECT_NEAR(at("tool_roll", "insertion"), 138.196, 1e-3);
  EXPECT_NEAR(at("tool_roll", "elbow"), 1.09244, 1e-5);
  EXPECT_NEAR(at("wrist_pitch", "insertion"), 92.4055, 1e-3);
  EXPECT_NEAR(at("wrist_yaw", "insertion"), 0.0, 1e-12) << "both fingers turn alike";
  EXPECT_EQ(at("shoulder", "insertion"), 0.0);
  EXPECT_EQ(CableCoupling().motorTravel(chain), JointMatrix::Identity(6, 6));
}

// Half a count of every motor, taken to the joints, bounds the error; one count of the insertion
// motor is 0.728 um (published).
TEST(CableCoupling, QuantisationIsHalfACount) {
  const CableCoupling coupling = shippedCoupling("raven2_gold");
  const KinematicChain chain = shippedRobot("raven2_gold");
  const double count = 2.0 * 3.14159265358979 / 4000.0;
  EXPECT_NEAR(count / 2158.59, 0.728e-6, 0.001e-6);
  std::mt19937_64 random(10);
  const int shoulder = chain.indexOf("shoulder");
  const int yaw = chain.indexOf("wrist_yaw");
  double largest = 0.0;
  for (int trial = 0; trial < 2000; ++trial) {
    const JointVector q = randomJoints(chain, random);
    const JointVector error = coupling.quantised(chain, q, 0.4) - q;
    largest = std::max(largest, std::abs(error(shoulder)));
    EXPECT_LE(std::abs(error(shoulder)), 0.5 * count / 136.196 * (1.0 + 1e-6));
    // Both fingers, and the tool rows follow the errors of the arm's motors: a few counts.
    EXPECT_LE(std::abs(error(yaw)), 3.0 * count / 8.992);
  }
  EXPECT_GT(largest, 0.45 * count / 136.196);
}

TEST(CableCoupling, RefusesASingularMatrix) {
  EXPECT_THROW(CableCoupling({"a", "b"}, {"a", "b"}, Eigen::MatrixXd::Ones(2, 2), 4000),
               InvalidInput);
  EXPECT_THROW(CableCoupling({"a"}, {"a"}, Eigen::MatrixXd::Ones(2, 2), 4000), InvalidInput);
  EXPECT_THROW(CableCoupling({"a"}, {"a"}, Eigen::MatrixXd::Ones(1, 1), 0), InvalidInput);
}

}  // namespace
}  // namespace raven_correction
