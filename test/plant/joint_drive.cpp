// SPDX-License-Identifier: BSD-3-Clause
#include "plant/joint_drive.h"

#include <algorithm>
#include <cmath>

namespace raven_correction::plant {
namespace {

constexpr double kStaticShare = 0.05;       // of F_c, by which sticking exceeds slipping
constexpr double kHysteresisStretch = 0.1;  // longest step of z, as a share of its bound

double sign(double x) { return x < 0.0 ? -1.0 : 1.0; }

}  // namespace

JointPhysics cleanJoint(bool revolute, double home) noexcept {
  // Only ratios matter at the tool: the controller is so stiff that gravity does nothing, and the
  // link so light and damped that it follows its cable without coasting. Set-points are held, so
  // the tool moves in steps of up to 2 mm: what sees it within the lag after one sees it far away,
  // and a diagnosis would rightly find a lag of 0.2 ms in a session of some thousand exposures.
  const double controller_rate = 2e5;  // sqrt(k_p / J_m) [1/s]
  JointPhysics joint;
  joint.home = home;
  joint.stiffness = revolute ? 2e5 : 4e6;
  joint.motor_inertia = joint.stiffness / (controller_rate * controller_rate);
  joint.damping = 2.0 * joint.stiffness / controller_rate;  // critical
  joint.motor_friction = revolute ? 1.0 : 2.0;              // w = 10 urad, 1 um
  joint.stribeck_speed = revolute ? 1e-3 : 1e-4;
  joint.cable_stiffness = 5.0 * joint.stiffness;
  joint.cable_damping = 1e-4 * joint.cable_stiffness;
  joint.link_inertia = 0.5 * joint.motor_inertia;
  joint.joint_viscous = controller_rate * joint.link_inertia;
  joint.joint_friction = revolute ? 0.05 : 0.2;
  joint.pretension = revolute ? 100.0 : 200.0;
  return joint;
}

JointDrive::JointDrive(const JointPhysics& physics, double setpoint) noexcept
    : physics_(physics), setpoint_(setpoint), m_(setpoint), q_(0.0) {
  q_ = pulley(m_);
}

double JointDrive::pulley(double m) const noexcept {
  const JointPhysics& p = physics_;
  double u = m + p.homing_error + p.radius_error * (m - p.home) - hysteresis_ + strain_;
  if (p.ripple != 0.0) u += p.ripple * std::sin(p.ripple_number * m + p.ripple_phase);
  return u + p.curvature * (m - p.middle) * (m - p.middle);
}

double JointDrive::pulleySlope(double m) const noexcept {
  const JointPhysics& p = physics_;
  double slope = 1.0 + p.radius_error + 2.0 * p.curvature * (m - p.middle);
  if (p.ripple != 0.0)
    slope += p.ripple * p.ripple_number * std::cos(p.ripple_number * m + p.ripple_phase);
  return slope;
}

double JointDrive::motorFriction() const noexcept {
  const JointPhysics& p = physics_;
  double friction = p.motor_friction;
  if (p.friction_waviness != 0.0)
    friction *= 1.0 + p.friction_waviness * std::sin(p.friction_wave_number * m_);
  const double speed = v_m_ / p.stribeck_speed;
  return std::abs(speed) > 4.0 ? friction
                               : friction * (1.0 + kStaticShare * std::exp(-speed * speed));
}

JointDrive::Velocities JointDrive::stickSlip(double a11, double a12, double a22, double b1,
                                             double b2, double f1, double f2) noexcept {
  // a11 x + a12 y + f1 sign(x) = b1,  a12 x + a22 y + f2 sign(y) = b2: nine cases, of which exactly
  // one holds (the matrix is positive definite). The one that held last usually holds again.
  const double slack = 1e-12 * (std::abs(b1) + std::abs(b2) + f1 + f2);
  for (int k = 0; k < 9; ++k) {
    const int slip = (slip_ + k) % 9;
    const double s1 = slip % 3 - 1;
    const double s2 = slip / 3 - 1;
    double x = 0.0;
    double y = 0.0;
    if (s1 != 0.0 && s2 != 0.0) {
      const double right1 = b1 - s1 * f1;
      const double right2 = b2 - s2 * f2;
      const double determinant = a11 * a22 - a12 * a12;
      x = (a22 * right1 - a12 * right2) / determinant;
      y = (a11 * right2 - a12 * right1) / determinant;
    } else if (s1 != 0.0) {
      x = (b1 - s1 * f1) / a11;
      if (std::abs(b2 - a12 * x) > f2 + slack) continue;
    } else if (s2 != 0.0) {
      y = (b2 - s2 * f2) / a22;
      if (std::abs(b1 - a12 * y) > f1 + slack) continue;
    } else if (std::abs(b1) > f1 + slack || std::abs(b2) > f2 + slack) {
      continue;
    }
    if (x * s1 < 0.0 || y * s2 < 0.0) continue;
    slip_ = slip;
    return {x, y};
  }
  return {0.0, 0.0};
}

JointDrive::Velocities JointDrive::solve(double h, double load, double rho,
                                         const Contact& contact) noexcept {
  const JointPhysics& p = physics_;
  const double friction = motorFriction();
  const double coupling = -rho * contact.gain;
  const double a22 = p.link_inertia / h + p.joint_viscous + contact.gain;
  const double b2 = p.link_inertia / h * v_q_ + contact.constant + load;
  const auto withDrive = [&](double constant, double slope) {  // drive = constant - slope v_m
    const double a11 = p.motor_inertia / h + p.motor_viscous + rho * rho * contact.gain + slope;
    const double b1 = p.motor_inertia / h * v_m_ - rho * contact.constant + constant;
    return stickSlip(a11, coupling, a22, b1, b2, friction, p.joint_friction);
  };
  const double constant = p.stiffness * (setpoint_ - m_);
  const double slope = p.stiffness * h + p.damping;
  const Velocities free = withDrive(constant, slope);
  if (!(p.no_load_speed > 0.0)) return free;
  const double drive = constant - slope * free.motor;
  const double droop = p.stall_force / p.no_load_speed;
  if (drive > p.stall_force - droop * free.motor) return withDrive(p.stall_force, droop);
  if (drive < -p.stall_force - droop * free.motor) return withDrive(-p.stall_force, droop);
  return free;
}

void JointDrive::bendHysteresis(double du) noexcept {
  const double bound = 0.5 * physics_.hysteresis_width;
  const int steps = static_cast<int>(std::abs(du) / (kHysteresisStretch * bound)) + 1;
  for (int k = 0; k < steps; ++k) {
    const double share = du * hysteresis_ > 0.0 ? std::pow(std::abs(hysteresis_) / bound,
                                                           physics_.hysteresis_sharpness)
                                                : 0.0;
    hysteresis_ = std::clamp(hysteresis_ + du / steps * (1.0 - share), -bound, bound);
  }
}

void JointDrive::step(double h, double load, double coupling, bool creeping) noexcept {
  const JointPhysics& p = physics_;
  const double rho = pulleySlope(m_);
  const double stretch = pulley(m_) + coupling - q_;
  const double half = 0.5 * p.play;
  const double gain = p.cable_stiffness * h + p.cable_damping;
  const double held = p.load_share * load;
  Contact contact{0.0, 0.0};
  Velocities v{};
  if (half > 0.0) {
    v = solve(h, held, rho, contact);  // slack, if that keeps it inside the dead zone
    const double slack_stretch = stretch + h * (rho * v.motor - v.joint);
    if (std::abs(slack_stretch) > half) {
      const double side = sign(slack_stretch);
      const Contact taut{p.cable_stiffness * (stretch - side * half), gain};
      const Velocities pushed = solve(h, held, rho, taut);
      if (side * (taut.constant + taut.gain * (rho * pushed.motor - pushed.joint)) > 0.0) {
        contact = taut;
        v = pushed;
      }
    }
  } else {
    contact = {p.cable_stiffness * stretch, gain};
    v = solve(h, held, rho, contact);
  }
  v_m_ = v.motor;
  v_q_ = v.joint;
  force_ = contact.constant + contact.gain * (rho * v_m_ - v_q_);
  m_ += h * v_m_;
  q_ += h * v_q_;
  if (p.hysteresis_width > 0.0 && v_m_ != 0.0) bendHysteresis(h * rho * v_m_);
  if (creeping && p.creep != 0.0) {
    const double settled = p.creep * (1.0 + force_ / p.pretension);
    strain_ += (settled - strain_) * (p.creep_time > 0.0 ? -std::expm1(-h / p.creep_time) : 1.0);
  }
}

}  // namespace raven_correction::plant
