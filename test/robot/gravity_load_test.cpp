// SPDX-License-Identifier: BSD-3-Clause
// The load of gravity is the change of potential energy with a joint, sign reversed.
#include "raven_correction/robot/gravity_load.h"

#include <gtest/gtest.h>

#include "robot/robots.h"

namespace raven_correction {
namespace {

double potentialEnergy(const KinematicChain& chain, const JointVector& q, double payload) {
  LinkPoses X_base_link;
  chain.linkPoses(q, X_base_link);
  double energy = -payload * chain.gravity().dot(chain.forward(q).p);
  for (int i = 0; i < chain.size(); ++i) {
    const Joint& joint = chain.joints()[static_cast<std::size_t>(i)];
    const Eigen::Vector3d c = X_base_link[static_cast<std::size_t>(i)] * joint.centre_of_mass;
    energy -= joint.mass * chain.gravity().dot(c);
  }
  return energy;
}

TEST(GravityLoad, IsTheGradientOfThePotential) {
  std::mt19937_64 random(8);
  const double h = 1e-5;
  for (const std::string& name : shippedRobots()) {
    const KinematicChain chain = shippedRobot(name);
    for (int trial = 0; trial < 50; ++trial) {
      const JointVector q = randomJoints(chain, random);
      const JointVector load = gravityLoad(chain, q, 0.3);
      for (int j = 0; j < chain.size(); ++j) {
        JointVector above = q;
        JointVector below = q;
        above(j) += h;
        below(j) -= h;
        const double slope =
            (potentialEnergy(chain, above, 0.3) - potentialEnergy(chain, below, 0.3)) / (2.0 * h);
        EXPECT_NEAR(load(j), -slope, 1e-8) << name << " joint " << j;
      }
    }
  }
}

// Both conventions describe the same masses, up to the 3.9 deg between their verticals.
TEST(GravityLoad, ConventionsAgree) {
  KinematicChain left = shippedRobot("raven2_left");
  KinematicChain gold = shippedRobot("raven2_gold");
  JointVector q_left = left.home();
  JointVector q_gold = gold.home();
  q_left(left.indexOf("insertion")) = -0.07;
  q_gold(gold.indexOf("insertion")) = 0.40;
  std::vector<Joint> joints = gold.joints();
  joints[0].mass = 0.572;  // the stacks weigh the links differently
  joints[1].mass = 0.672;
  joints[2].mass = 0.238;
  Eigen::Matrix3d R_0link_crtk;
  R_0link_crtk << 0, 1, 0, -0.997637, 0, -0.068710, -0.068710, 0, 0.997637;
  KinematicChain same("gold", "base", gold.baseTransform(), joints, gold.toolTransform());
  same.setGravity(R_0link_crtk.transpose() * left.gravity());
  const JointVector a = gravityLoad(left, q_left, 0.0);
  const JointVector b = gravityLoad(same, q_gold, 0.0);
  for (const char* joint : {"shoulder", "elbow", "insertion"})
    EXPECT_NEAR(a(left.indexOf(joint)), b(same.indexOf(joint)), 1e-3) << joint;
}

}  // namespace
}  // namespace raven_correction
