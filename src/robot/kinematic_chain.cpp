// SPDX-License-Identifier: BSD-3-Clause
#include "raven_correction/robot/kinematic_chain.h"

#include <cmath>

#include "raven_correction/error.h"

namespace raven_correction {
namespace {

bool isFiniteJoint(const Joint& joint) {
  return std::isfinite(joint.alpha) && std::isfinite(joint.a) &&
         std::isfinite(joint.theta_offset) && std::isfinite(joint.d_offset) &&
         std::isfinite(joint.mass) && joint.centre_of_mass.allFinite();
}

void check(const Joint& joint) {
  const char* name = joint.name.c_str();
  if (joint.name.empty()) throw InvalidInput("a joint has no name");
  if (!isFiniteJoint(joint)) throw InvalidInput(format("joint %s: a value is not finite", name));
  if (std::abs(joint.sign) != 1.0)
    throw InvalidInput(format("joint %s: sign = %g, must be 1 or -1", name, joint.sign));
  if (!(joint.mass >= 0.0))
    throw InvalidInput(format("joint %s: mass = %g kg, must be >= 0", name, joint.mass));
  if (!(joint.lower < joint.upper))
    throw InvalidInput(format("joint %s: lower limit %g is not below the upper limit %g", name,
                              joint.lower, joint.upper));
  if (!(joint.home >= joint.lower && joint.home <= joint.upper))
    throw InvalidInput(format("joint %s: home %g is outside its limits [%g, %g]", name, joint.home,
                              joint.lower, joint.upper));
}

/// Axes and origin of a frame in `base`, moved along the chain row by row.
struct Frame {
  Eigen::Vector3d x, y, z, p;

  explicit Frame(const Pose& X) {
    const Eigen::Matrix3d R = X.q.toRotationMatrix();
    x = R.col(0);
    y = R.col(1);
    z = R.col(2);
    p = X.p;
  }
  /// Rx(alpha) Dx(a)
  void alongX(double cos_alpha, double sin_alpha, double a) noexcept {
    p += a * x;
    const Eigen::Vector3d y_before = y;
    y = cos_alpha * y_before + sin_alpha * z;
    z = cos_alpha * z - sin_alpha * y_before;
  }
  /// Rz(theta) Dz(d)
  void alongZ(double theta, double d) noexcept {
    const double c = std::cos(theta);
    const double s = std::sin(theta);
    const Eigen::Vector3d x_before = x;
    x = c * x_before + s * y;
    y = c * y - s * x_before;
    p += d * z;
  }
  Pose pose() const noexcept {
    Eigen::Matrix3d R;
    R << x, y, z;
    return {p, Eigen::Quaterniond(R).normalized()};
  }
};

}  // namespace

KinematicChain::KinematicChain(std::string name, std::string frame, const Pose& X_base_0,
                               std::vector<Joint> joints, const Pose& X_n_tool)
    : name_(std::move(name)),
      frame_(std::move(frame)),
      X_base_0_(X_base_0),
      X_n_tool_(X_n_tool),
      joints_(std::move(joints)) {
  const int n = size();
  if (n == 0) throw InvalidInput("a kinematic chain needs at least one joint");
  if (n > kMaxJoints)
    throw InvalidInput(format("%d joints, at most %d are supported", n, kMaxJoints));
  if (!isFinite(X_base_0) || !hasUnitQuaternion(X_base_0) || !isFinite(X_n_tool) ||
      !hasUnitQuaternion(X_n_tool))
    throw InvalidInput("base or tool transform is not a rigid transform");
  home_.resize(n);
  lower_.resize(n);
  upper_.resize(n);
  for (int i = 0; i < n; ++i) {
    const Joint& joint = joints_[i];
    check(joint);
    if (find(joint.name) != i)
      throw InvalidInput(format("two joints are named %s", joint.name.c_str()));
    home_(i) = joint.home;
    lower_(i) = joint.lower;
    upper_(i) = joint.upper;
    const bool revolute = joint.type == JointType::kRevolute;
    rows_.push_back({std::cos(joint.alpha), std::sin(joint.alpha), joint.a, joint.theta_offset,
                     joint.d_offset, revolute ? joint.sign : 0.0, revolute ? 0.0 : joint.sign});
  }
}

std::vector<std::string> KinematicChain::jointNames() const {
  std::vector<std::string> names;
  for (const Joint& joint : joints_) names.push_back(joint.name);
  return names;
}

int KinematicChain::find(const std::string& joint_name) const noexcept {
  for (int i = 0; i < size(); ++i)
    if (joints_[i].name == joint_name) return i;
  return -1;
}

int KinematicChain::indexOf(const std::string& joint_name) const {
  const int index = find(joint_name);
  if (index >= 0) return index;
  std::string names;
  for (const Joint& joint : joints_) names += (names.empty() ? "" : ", ") + joint.name;
  throw InvalidInput(
      format("%s has no joint %s; it has: %s", name_.c_str(), joint_name.c_str(), names.c_str()));
}

bool KinematicChain::withinLimits(const JointVector& q, double tolerance) const noexcept {
  if (q.size() != size()) return false;
  for (int i = 0; i < size(); ++i)
    if (!(q(i) >= lower_(i) - tolerance && q(i) <= upper_(i) + tolerance)) return false;
  return true;
}

JointVector KinematicChain::clamp(const JointVector& q) const noexcept {
  return q.cwiseMax(lower_).cwiseMin(upper_);
}

Pose KinematicChain::forward(const JointVector& q) const noexcept {
  Frame frame(X_base_0_);
  for (int i = 0; i < size(); ++i) {
    const Row& row = rows_[i];
    frame.alongX(row.cos_alpha, row.sin_alpha, row.a);
    frame.alongZ(row.theta + row.revolute_gain * q(i), row.d + row.prismatic_gain * q(i));
  }
  return frame.pose() * X_n_tool_;
}

Pose KinematicChain::forward(const JointVector& q, Jacobian& jacobian) const noexcept {
  const int n = size();
  Frame frame(X_base_0_);
  Eigen::Matrix<double, 3, kMaxJoints> origins;
  jacobian.resize(6, n);
  for (int i = 0; i < n; ++i) {
    const Row& row = rows_[i];
    frame.alongX(row.cos_alpha, row.sin_alpha, row.a);
    origins.col(i) = frame.p;  // any point of the axis will do
    jacobian.col(i).head<3>() = row.prismatic_gain * frame.z;
    jacobian.col(i).tail<3>() = row.revolute_gain * frame.z;
    frame.alongZ(row.theta + row.revolute_gain * q(i), row.d + row.prismatic_gain * q(i));
  }
  const Pose X_base_tool = frame.pose() * X_n_tool_;
  for (int i = 0; i < n; ++i) {
    const Eigen::Vector3d axis = jacobian.col(i).tail<3>();  // zero for a prismatic joint
    jacobian.col(i).head<3>() += axis.cross(X_base_tool.p - origins.col(i));
  }
  return X_base_tool;
}

void KinematicChain::linkPoses(const JointVector& q, LinkPoses& poses) const noexcept {
  Frame frame(X_base_0_);
  for (int i = 0; i < size(); ++i) {
    const Row& row = rows_[i];
    frame.alongX(row.cos_alpha, row.sin_alpha, row.a);
    frame.alongZ(row.theta + row.revolute_gain * q(i), row.d + row.prismatic_gain * q(i));
    poses[static_cast<std::size_t>(i)] = frame.pose();
  }
}

}  // namespace raven_correction
