// SPDX-License-Identifier: BSD-3-Clause
// A serial robot as modified Denavit-Hartenberg rows, with names, limits and link masses: where the
// tool is for given joints, and how it moves. Reading one from YAML is chain_file.h, the way back
// from pose to joints is inverse_kinematics.h.
#pragma once

#include <Eigen/Core>
#include <array>
#include <string>
#include <vector>

#include "raven_correction/geometry/pose.h"

namespace raven_correction {

/// No robot of this package has more joints; vectors of joints therefore never allocate.
constexpr int kMaxJoints = 8;
/// One value per joint, in the order of the chain's rows [rad or m].
using JointVector = Eigen::Matrix<double, Eigen::Dynamic, 1, Eigen::ColMajor, kMaxJoints, 1>;
/// 6xN: rows linear velocity x y z, angular velocity x y z, in `base`; one column per joint.
using Jacobian = Eigen::Matrix<double, 6, Eigen::Dynamic, Eigen::ColMajor, 6, kMaxJoints>;
/// One row and one column per joint.
using JointMatrix =
    Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, kMaxJoints, kMaxJoints>;

/// Poses of the links in `base`; the first size() of a chain are used.
using LinkPoses = std::array<Pose, kMaxJoints>;

enum class JointType { kRevolute, kPrismatic };

/// One row of the table: T = Rx(alpha) Dx(a) Rz(theta) Dz(d); alpha and a belong to the link
/// before.
///
///   revolute:  theta = sign q + theta_offset,  d = d_offset
///   prismatic: theta = theta_offset,           d = sign q + d_offset
///
/// Source: Craig 2005, Introduction to Robotics, section 3.4
struct Joint {
  std::string name;
  JointType type = JointType::kRevolute;
  double alpha = 0.0;         ///< [rad]
  double a = 0.0;             ///< [m]
  double theta_offset = 0.0;  ///< [rad]
  double d_offset = 0.0;      ///< [m]
  double sign = 1.0;          ///< +1 or -1
  double lower = 0.0;         ///< smallest value of q [rad or m]
  double upper = 0.0;         ///< largest value of q [rad or m]
  double home = 0.0;          ///< homing position [rad or m]
  double mass = 0.0;          ///< of the link that this joint moves [kg]
  Eigen::Vector3d centre_of_mass = Eigen::Vector3d::Zero();  ///< in the frame after this row [m]
};

/// Base transform, rows and tool transform: X_base_tool(q) = X_base_0 T_1(q_1) ... T_n(q_n)
/// X_n_tool.
class KinematicChain {
 public:
  KinematicChain() = default;
  /// @param frame     name of the frame that poses are given in, e.g. `0_link`
  /// @param X_base_0  the frame before the first row, in `base`
  /// @param X_n_tool  the tool in the frame after the last row
  /// @throws InvalidInput  no row, more than kMaxJoints, a name twice, a sign other than +-1, a
  ///                       value that is not finite, lower >= upper, or home outside the limits
  KinematicChain(std::string name, std::string frame, const Pose& X_base_0,
                 std::vector<Joint> joints, const Pose& X_n_tool);

  const std::string& name() const noexcept { return name_; }
  const std::string& frame() const noexcept { return frame_; }
  int size() const noexcept { return static_cast<int>(joints_.size()); }
  const std::vector<Joint>& joints() const noexcept { return joints_; }
  const Pose& baseTransform() const noexcept { return X_base_0_; }
  const Pose& toolTransform() const noexcept { return X_n_tool_; }
  /// Acceleration of gravity in `base` [m/s^2]; zero unless it was set.
  const Eigen::Vector3d& gravity() const noexcept { return gravity_; }
  void setGravity(const Eigen::Vector3d& gravity) noexcept { gravity_ = gravity; }
  std::vector<std::string> jointNames() const;
  /// Row of the joint with this name, or -1.
  int find(const std::string& joint_name) const noexcept;
  /// Row of the joint with this name.
  /// @throws InvalidInput  no such joint; the text lists those there are
  int indexOf(const std::string& joint_name) const;

  const JointVector& home() const noexcept { return home_; }
  const JointVector& lower() const noexcept { return lower_; }
  const JointVector& upper() const noexcept { return upper_; }
  /// lower - tolerance <= q <= upper + tolerance for every joint; false for NaN.
  bool withinLimits(const JointVector& q, double tolerance = 0.0) const noexcept;
  /// q, with each joint brought to its nearer limit where it is outside.
  JointVector clamp(const JointVector& q) const noexcept;

  /// X_base_tool for joints q. No limit is applied. About 0.3 us.
  Pose forward(const JointVector& q) const noexcept;
  /// forward() and the geometric Jacobian of the tool point at once.
  Pose forward(const JointVector& q, Jacobian& jacobian) const noexcept;
  /// Pose of the frame after every row, in `base`; element i belongs to joint i.
  void linkPoses(const JointVector& q, LinkPoses& poses) const noexcept;

 private:
  struct Row {  // what the live path needs of a Joint, with the constant sines taken
    double cos_alpha, sin_alpha, a, theta, d, revolute_gain, prismatic_gain;
  };
  std::string name_;
  std::string frame_;
  Pose X_base_0_;
  Pose X_n_tool_;
  Eigen::Vector3d gravity_ = Eigen::Vector3d::Zero();
  std::vector<Joint> joints_;
  std::vector<Row> rows_;
  JointVector home_;
  JointVector lower_;
  JointVector upper_;
};

}  // namespace raven_correction
