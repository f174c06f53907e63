// SPDX-License-Identifier: BSD-3-Clause
// Between motors and joints of a cable-driven arm: cables of one joint run over pulleys of others,
// so each motor turns for several joints. Also what an encoder on the motor can tell of a joint.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "raven_correction/robot/kinematic_chain.h"

namespace raven_correction {

/// Motor angles for joint positions, and back:
///
///   m = M q,   q = inv(M) m,   counts = round(m n / 2 pi)
///
/// q holds the actuated joints: those of the chain, but both fingers where the chain has the wrist
/// yaw (yaw = (g2 - g1) / 2, opening = g1 + g2). m in rad at the motor, n counts per motor turn.
/// Source: fwd_cable_coupling and inv_cable_coupling of both public Raven stacks.
class CableCoupling {
 public:
  CableCoupling() = default;
  /// @param joints           names of the actuated joints, in the order of the columns of M
  /// @param motors           names of the motors, in the order of the rows; as many as joints
  /// @param motors_per_joint M, motor angle per joint position [rad/rad or rad/m]
  /// @param counts_per_turn  of the encoder on each motor, > 0
  /// @throws InvalidInput  sizes differ, a value is not finite, or M is singular
  CableCoupling(std::vector<std::string> joints, std::vector<std::string> motors,
                const Eigen::MatrixXd& motors_per_joint, double counts_per_turn);

  bool empty() const noexcept { return joints_.empty(); }
  const std::vector<std::string>& joints() const noexcept { return joints_; }
  const std::vector<std::string>& motors() const noexcept { return motors_; }
  double countsPerTurn() const noexcept { return counts_per_turn_; }

  Eigen::VectorXd motorsFromJoints(const Eigen::VectorXd& q) const { return M_ * q; }
  Eigen::VectorXd jointsFromMotors(const Eigen::VectorXd& m) const { return M_inverse_ * m; }
  /// What encoders with whole counts report for these joints, taken back to joints.
  Eigen::VectorXd quantised(const Eigen::VectorXd& q) const;
  /// The same for the joints of a chain, the fingers at this jaw opening [rad].
  JointVector quantised(const KinematicChain& chain, const JointVector& q, double jaw) const;
  /// Motor travel in units of the joint that the motor is there for: u = C q, unit diagonal. On a
  /// Raven, u of the tool roll is q + 138 rad/m q_insertion + 1.1 (q_shoulder + q_elbow). A joint
  /// without a motor of its name has no entry but its own; the wrist yaw is half the difference of
  /// the fingers.
  JointMatrix motorTravel(const KinematicChain& chain) const;

 private:
  std::vector<std::string> joints_;
  std::vector<std::string> motors_;
  Eigen::MatrixXd M_;
  Eigen::MatrixXd M_inverse_;
  double counts_per_turn_ = 0.0;
};

/// Reads the section `transmission` of a robot file; empty if there is none.
/// @throws InvalidInput  as loadKinematicChain()
CableCoupling loadCableCoupling(const std::string& robot_path);
/// The same from the text of such a file; `name` stands for the file in messages.
CableCoupling cableCouplingFromText(const std::string& text, const std::string& name);

}  // namespace raven_correction
