// SPDX-License-Identifier: BSD-3-Clause
// Forward kinematics against published and computed poses, the Jacobian against differences.
#include "raven_correction/robot/kinematic_chain.h"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <sstream>

#include "raven_correction/error.h"
#include "raven_correction/robot/fingers.h"
#include "robot/robots.h"

namespace raven_correction {
namespace {

constexpr double kDegree = 3.14159265358979323846 / 180.0;

JointVector jointsOf(const KinematicChain& chain, double shoulder, double elbow, double insertion,
                     double roll, double pitch, double g1, double g2) {
  JointVector q(6);
  q(chain.indexOf("shoulder")) = shoulder;
  q(chain.indexOf("elbow")) = elbow;
  q(chain.indexOf("insertion")) = insertion;
  q(chain.indexOf("tool_roll")) = roll;
  q(chain.indexOf("wrist_pitch")) = pitch;
  q(chain.indexOf("wrist_yaw")) = Fingers{g1, g2}.yaw();
  return q;
}

// Forty poses computed from the published tables by another program; six decimals.
TEST(ForwardKinematics, TestVectors) {
  std::ifstream file("test/robot/vectors/forward_kinematics.csv");
  std::string line;
  std::getline(file, line);
  int count = 0;
  while (std::getline(file, line)) {
    std::istringstream cells(line);
    std::string robot;
    std::getline(cells, robot, ',');
    double v[14];
    for (double& value : v) {
      std::string cell;
      std::getline(cells, cell, ',');
      value = std::stod(cell);
    }
    const KinematicChain chain = shippedRobot(robot);
    const Pose X = chain.forward(jointsOf(chain, v[0], v[1], v[2], v[3], v[4], v[5], v[6]));
    // Joints and poses are rounded to 5e-7; the arm is 0.23 m long, joint errors add up over six.
    EXPECT_LT((X.p - Eigen::Vector3d(v[7], v[8], v[9])).cwiseAbs().maxCoeff(), 1.5e-6) << line;
    const Eigen::Quaterniond expected(v[13], v[10], v[11], v[12]);
    const double sign = expected.dot(X.q) < 0.0 ? -1.0 : 1.0;
    EXPECT_LT((sign * X.q.coeffs() - expected.coeffs()).cwiseAbs().maxCoeff(), 2.5e-6) << line;
    ++count;
  }
  EXPECT_EQ(count, 40);
}

struct PublishedPose {
  const char* robot;
  double q[7];         // shoulder, elbow, insertion, roll, pitch, g1, g2 [rad, m]
  double position[3];  // computed [m]
  double zyx[3];       // computed [deg]
};

// The three configurations that the Berkeley code publishes with its kinematics.
TEST(ForwardKinematics, PublishedConfigurations) {
  const double d = kDegree;
  const PublishedPose table[] = {
      {"raven2_left",
       {20.6 * d, 79.0 * d, -0.112, -84.3 * d, 29.5 * d, 32.8 * d, 29.2 * d},
       {0.007898, -0.000634, -0.131352},
       {24.66, 62.21, 179.55}},
      {"raven2_right",
       {6.3 * d, 107.1 * d, -0.085, 20.0 * d, -2.8 * d, -41.9 * d, -15.1 * d},
       {-0.109320, 0.017660, -0.098006},
       {54.34, 71.00, 165.11}},
      {"raven2_left",
       {0.517, 1.623, -0.05, 0.16, 0.161, 0.99, 1.023},
       {-0.015267, -0.013792, -0.068790},
       {-160.67, 75.69, -87.34}},
      {"raven2_right",
       {0.511, 1.607, -0.05, 0.109, 0.110, -0.652, -0.634},
       {-0.135925, -0.016883, -0.068220},
       {-66.24, 68.78, 40.28}},
      {"raven2_left",
       {0.517, 1.621, -0.04995, 0.084, 0.123, 0.946, 0.977},
       {-0.014720, -0.014530, -0.068791},
       {-151.15, 75.96, -73.92}},
      {"raven2_right",
       {0.509, 1.609, -0.04984, 0.111, 0.117, -0.637, -0.604},
       {-0.135965, -0.016847, -0.068055},
       {-67.54, 68.81, 39.14}}};
  for (const PublishedPose& row : table) {
    const KinematicChain chain = shippedRobot(row.robot);
    const double* q = row.q;
    const Pose X = chain.forward(jointsOf(chain, q[0], q[1], q[2], q[3], q[4], q[5], q[6]));
    const Eigen::Vector3d zyx = zyxAngles(X.q.toRotationMatrix()) / d;
    for (int i = 0; i < 3; ++i) {
      EXPECT_NEAR(X.p(i), row.position[i], 0.6e-6) << row.robot;
      EXPECT_NEAR(zyx(i), row.zyx[i], 0.006) << row.robot;
    }
  }
}

TEST(ForwardKinematics, NominalHome) {
  const double h = 45.0 * kDegree;
  const struct {
    const char* robot;
    double insertion;
    double v[7];
  } table[] = {{"raven2_left",
                -0.05,
                {-0.011473, -0.017219, -0.068963, 0.343838, 0.528424, -0.548125, 0.549639}},
               {"raven2_right",
                -0.05,
                {-0.137107, -0.015219, -0.068963, 0.528424, 0.343838, -0.549639, 0.548125}},
               {"raven2_gold",
                0.40,
                {0.025266, -0.013226, -0.077947, -0.130481, 0.589734, -0.003417, 0.796980}},
               {"raven2_green",
                0.40,
                {0.025266, 0.013226, -0.077947, 0.130481, 0.589734, 0.003417, 0.796980}}};
  for (const auto& row : table) {
    const KinematicChain chain = shippedRobot(row.robot);
    const Pose X = chain.forward(
        jointsOf(chain, 30.0 * kDegree, 90.0 * kDegree, row.insertion, 0.0, 0.0, h, h));
    const double* v = row.v;
    EXPECT_LT((X.p - Eigen::Vector3d(v[0], v[1], v[2])).cwiseAbs().maxCoeff(), 0.6e-6);
    const Eigen::Quaterniond expected(v[6], v[3], v[4], v[5]);
    EXPECT_LT(rotationAngle(expected, X.q), 2e-6) << row.robot;
  }
}

// The controller's published home poses are rounded to 0.1 mm and measured with other joint digits.
TEST(ForwardKinematics, PublishedHomeOfTheCrtkBranch) {
  const KinematicChain gold = shippedRobot("raven2_gold");
  const Pose X_gold =
      gold.forward(jointsOf(gold, 0.523, 1.584, 0.4002, 0.0715, 0.0950, 0.7537, 0.852));
  EXPECT_LT((X_gold.p - Eigen::Vector3d(0.024117, -0.014342, -0.077848)).norm(), 1e-6);
  const KinematicChain green = shippedRobot("raven2_green");
  const Pose X_green =
      green.forward(jointsOf(green, 0.524, 1.583, 0.400, 0.0660, 0.0598, 0.736, 0.844));
  EXPECT_LT((X_green.p - Eigen::Vector3d(0.024667, 0.014096, -0.077965)).norm(), 1e-6);
}

// The two conventions describe one robot: at yaw 0 the tool points differ by 9 mm along the tool's
// x.
TEST(ForwardKinematics, ConventionsAgree) {
  Eigen::Matrix3d R_0link_crtk;
  R_0link_crtk << 0, 1, 0, -0.997637, 0, -0.068710, -0.068710, 0, 0.997637;
  const KinematicChain left = shippedRobot("raven2_left");
  const KinematicChain gold = shippedRobot("raven2_gold");
  const Pose X_left = left.forward(jointsOf(left, 0.7, 1.4, -0.12, 0.3, 0.4, 0.5, 0.5));
  const Pose X_gold = gold.forward(jointsOf(gold, 0.7, 1.4, 0.35, 0.3, 0.4, 0.5, 0.5));
  const Eigen::Matrix3d R = R_0link_crtk * X_gold.q.toRotationMatrix();
  EXPECT_LT((X_left.q.toRotationMatrix() - R).cwiseAbs().maxCoeff(), 1e-4);
  const Eigen::Vector3d expected = R_0link_crtk * X_gold.p + 0.009 * R.col(0);
  EXPECT_LT((X_left.p - expected).norm(), 1e-5);
}

TEST(Jacobian, EqualsCentralDifferences) {
  std::mt19937_64 random(1);
  const double h = 1e-6;  // error of the difference: h^2 ~ 1e-12 and rounding 1e-16 / h ~ 1e-10
  for (const std::string& name : shippedRobots()) {
    const KinematicChain chain = shippedRobot(name);
    for (int trial = 0; trial < 100; ++trial) {
      const JointVector q = randomJoints(chain, random);
      Jacobian J;
      const Pose X = chain.forward(q, J);
      EXPECT_TRUE(X.p == chain.forward(q).p);
      for (int i = 0; i < chain.size(); ++i) {
        JointVector above = q;
        JointVector below = q;
        above(i) += h;
        below(i) -= h;
        const Pose A = chain.forward(above);
        const Pose B = chain.forward(below);
        const Eigen::Vector3d v = (A.p - B.p) / (2.0 * h);
        const Eigen::Vector3d w = logRotation(A.q * B.q.conjugate()) / (2.0 * h);
        EXPECT_LT((J.col(i).head<3>() - v).norm(), 1e-8) << name;
        EXPECT_LT((J.col(i).tail<3>() - w).norm(), 1e-8) << name;
      }
    }
  }
}

TEST(KinematicChain, LinkPosesEndBeforeTheTool) {
  const KinematicChain chain = shippedRobot("psm");
  std::mt19937_64 random(2);
  const JointVector q = randomJoints(chain, random);
  LinkPoses links;
  chain.linkPoses(q, links);
  const Pose X = links[5] * chain.toolTransform();
  EXPECT_LT((X.p - chain.forward(q).p).norm(), 1e-15);
  EXPECT_LT(rotationAngle(X.q, chain.forward(q).q), 1e-14);
}

TEST(KinematicChain, RefusesWhatIsNoRobot) {
  Joint joint;
  joint.name = "one";
  joint.lower = -1.0;
  joint.upper = 1.0;
  EXPECT_NO_THROW(KinematicChain("a", "base", Pose(), {joint}, Pose()));
  EXPECT_THROW(KinematicChain("a", "base", Pose(), {}, Pose()), InvalidInput);
  EXPECT_THROW(KinematicChain("a", "base", Pose(), {joint, joint}, Pose()), InvalidInput);
  joint.home = 2.0;
  EXPECT_THROW(KinematicChain("a", "base", Pose(), {joint}, Pose()), InvalidInput);
  joint.home = 0.0;
  joint.sign = 0.5;
  EXPECT_THROW(KinematicChain("a", "base", Pose(), {joint}, Pose()), InvalidInput);
  joint.sign = 1.0;
  joint.alpha = std::nan("");
  EXPECT_THROW(KinematicChain("a", "base", Pose(), {joint}, Pose()), InvalidInput);
}

TEST(Fingers, RoundTrip) {
  const Fingers fingers = Fingers::from(0.3, 1.2);
  EXPECT_DOUBLE_EQ(fingers.yaw(), 0.3);
  EXPECT_DOUBLE_EQ(fingers.opening(), 1.2);
  EXPECT_DOUBLE_EQ(largestYaw(1.0, 1.5), 1.0);
}

}  // namespace
}  // namespace raven_correction
