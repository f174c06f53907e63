// SPDX-License-Identifier: BSD-3-Clause
#include "plant/robot_plant.h"

#include <algorithm>
#include <cmath>

#include "raven_correction/robot/gravity_load.h"

namespace raven_correction::plant {
namespace {

constexpr double kTwoPi = 6.283185307179586;
constexpr double kLoadPeriod = 2e-3;  // gravity changes slowly: it is looked at this often [s]
constexpr double kStepGrowth = 0.3;   // of a step with the time since the set-point changed
constexpr double kWobblesPerTurn = 8.0;
constexpr double kDistortionLength = 0.05;  // [m]

bool isSameAxis(const Joint& row) { return row.alpha == 0.0 && row.a == 0.0; }

/// Rows of the insertion and of the roll about the same axis; -1 where a chain has none.
struct ShaftRows {
  int insertion = -1;
  int roll = -1;
};

ShaftRows shaftRows(const KinematicChain& chain) {
  ShaftRows rows;
  for (int j = 0; j < chain.size(); ++j)
    if (chain.joints()[static_cast<std::size_t>(j)].type == JointType::kPrismatic)
      rows.insertion = j;
  if (rows.insertion < 0) return rows;
  const int after = rows.insertion + 1;
  if (rows.insertion > 0 && isSameAxis(chain.joints()[static_cast<std::size_t>(rows.insertion)]))
    rows.roll = rows.insertion - 1;
  else if (after < chain.size() && isSameAxis(chain.joints()[static_cast<std::size_t>(after)]))
    rows.roll = after;
  return rows;
}

}  // namespace

RobotPhysics cleanRobot(const KinematicChain& nominal) {
  RobotPhysics physics;
  physics.nominal = nominal;
  physics.chain = nominal;
  for (const Joint& joint : nominal.joints())
    physics.joints.push_back(cleanJoint(joint.type == JointType::kRevolute, joint.home));
  physics.coupling = Eigen::MatrixXd::Zero(nominal.size(), nominal.size());
  return physics;
}

RobotPlant::RobotPlant(const RobotPhysics& physics, const JointVector& joints, double now,
                       double session_start)
    : physics_(physics),
      time_(now),
      session_start_(session_start),
      changed_(now),
      load_time_(now),
      load_(gravityLoad(physics.chain, joints, 0.0)),
      coupled_(!physics.coupling.isZero(0.0) || physics.product.moved >= 0) {
  for (std::size_t j = 0; j < physics_.joints.size(); ++j)
    drives_.emplace_back(physics_.joints[j], joints(static_cast<Eigen::Index>(j)));
}

void RobotPlant::command(double stamp, const JointVector& joints) {
  queue_.push_back({stamp + physics_.delay, joints});
}

void RobotPlant::integrate(double end) {
  const int n = static_cast<int>(drives_.size());
  const bool creeping = time_ >= session_start_;
  steps_.clear();
  for (double t = time_; t < end;) {
    const double h = std::min(kStep, kFirstStep + kStepGrowth * (t - changed_));
    steps_.push_back(end - t < 1.5 * h ? end - t : h);
    t = end - t < 1.5 * h ? end : t + h;
  }
  if (!coupled_) {
    for (int j = 0; j < n; ++j)
      for (const double h : steps_) drives_[j].step(h, load_(j), 0.0, creeping);
    return;
  }
  for (const double h : steps_) {
    const JointVector away = joints() - physics_.nominal.home();
    JointVector pulled = physics_.coupling * away;
    const ProductCoupling& product = physics_.product;
    if (product.moved >= 0)
      pulled += product.c * (drives_[product.a].joint() - product.middle_a) *
                (drives_[product.b].joint() - product.middle_b) *
                JointVector::Unit(n, product.moved);
    for (int j = 0; j < n; ++j) drives_[j].step(h, load_(j), pulled(j), creeping);
  }
}

void RobotPlant::advanceTo(double time) {
  while (time_ < time) {
    while (!queue_.empty() && queue_.front().stamp <= time_) {
      for (std::size_t j = 0; j < drives_.size(); ++j)
        drives_[j].setSetpoint(queue_.front().joints(static_cast<Eigen::Index>(j)));
      queue_.pop_front();
      changed_ = time_;
    }
    if (time_ >= load_time_ + kLoadPeriod) {
      load_ = gravityLoad(physics_.chain, joints(), 0.0);
      load_time_ = time_;
    }
    double end = std::min(time, time_ + kLoadPeriod);
    if (!queue_.empty()) end = std::min(end, queue_.front().stamp);
    if (time_ < session_start_) end = std::min(end, session_start_);
    integrate(end);
    time_ = end;
  }
}

JointVector RobotPlant::setpoints() const {
  JointVector r = JointVector::Zero(static_cast<Eigen::Index>(drives_.size()));
  for (std::size_t j = 0; j < drives_.size(); ++j)
    r(static_cast<Eigen::Index>(j)) = drives_[j].setpoint();
  return r;
}

JointVector RobotPlant::motors() const {
  JointVector m = JointVector::Zero(static_cast<Eigen::Index>(drives_.size()));
  for (std::size_t j = 0; j < drives_.size(); ++j)
    m(static_cast<Eigen::Index>(j)) = drives_[j].motor();
  return m;
}

JointVector RobotPlant::joints() const {
  JointVector q = JointVector::Zero(static_cast<Eigen::Index>(drives_.size()));
  for (std::size_t j = 0; j < drives_.size(); ++j)
    q(static_cast<Eigen::Index>(j)) = drives_[j].joint();
  return q;
}

Pose RobotPlant::motorPose() const { return physics_.nominal.forward(motors()); }

Pose RobotPlant::bentForward() const {
  const OutsidePhysics& outside = physics_.outside;
  JointVector q = joints();
  if (outside.thermal_amplitude == 0.0 && outside.shaft_wave == 0.0 && outside.wobble == 0.0)
    return physics_.chain.forward(q);
  const ShaftRows rows = shaftRows(physics_.chain);
  if (rows.insertion < 0 || rows.roll < 0) return physics_.chain.forward(q);
  q += outside.thermal_amplitude *
       std::sin(kTwoPi * (time_ - session_start_) / outside.thermal_period) *
       JointVector::Unit(physics_.chain.size(), rows.insertion);
  Pose X = physics_.chain.forward(q);
  LinkPoses X_base_link;
  physics_.chain.linkPoses(q, X_base_link);
  const Eigen::Quaterniond& R_base_shaft =
      X_base_link[static_cast<std::size_t>(std::max(rows.insertion, rows.roll))].q;
  const double roll =
      physics_.chain.joints()[static_cast<std::size_t>(rows.roll)].sign * q(rows.roll);
  const double wave =
      outside.shaft_wave * std::sin(kTwoPi * q(rows.insertion) / outside.shaft_wave_length);
  const double turn = kWobblesPerTurn * roll;
  const Eigen::Vector3d with_roll = wave * Eigen::Vector3d(0.6, 0.8, 0.0);
  const Eigen::Vector3d wobble =
      outside.wobble * Eigen::Vector3d(std::cos(turn), std::sin(turn), 0.0);
  X.p += R_base_shaft * (with_roll + expRotation(Eigen::Vector3d(0.0, 0.0, -roll)) * wobble);
  return X;
}

Pose RobotPlant::observedPose() const {
  const OutsidePhysics& outside = physics_.outside;
  const double session_time = time_ - session_start_;
  Pose X = physics_.X_base_robot * bentForward() * physics_.X_tool_markers;
  if (outside.sway != 0.0)
    X.p += outside.sway * std::sin(kTwoPi * outside.sway_frequency * session_time) *
           Eigen::Vector3d(0.8, 0.6, 0.0);
  if (outside.distortion != 0.0) {
    const Eigen::Vector3d x = (X.p - physics_.volume_middle) / kDistortionLength;
    X.p += outside.distortion * Eigen::Vector3d(x.y() * x.z(), x.z() * x.z() - x.x() * x.x(),
                                                x.x() * x.x() - x.y() * x.x());
  }
  if (physics_.bump_time >= 0.0 && session_time >= physics_.bump_time) X = physics_.bump * X;
  X.p *= 1.0 + physics_.mocap_scale;
  return X;
}

}  // namespace raven_correction::plant
