// SPDX-License-Identifier: BSD-3-Clause
// Physics of one cable-driven joint at a small step: motor under PD control with friction, cable as
// spring and damper with play and creep, link with friction and load. How six of them and the
// kinematics make a robot is robot_plant.h; what each constant hides is hidden_effect.h.
#pragma once

namespace raven_correction::plant {

/// All quantities are in joint units: a motor is described by what it is at the joint, behind its
/// gear. Units for a revolute joint; a prismatic one has m for rad and N for Nm.
///
///   motor:  J_m dv_m/dt = drive - rho F - viscous v_m - friction(v_m)
///           drive = k_p (r - m) - k_d v_m, limited to what the motor can do at speed v_m:
///           -F_s (1 + v_m / v_0) <= drive <= F_s (1 - v_m / v_0)       (F_s stall, v_0 no load)
///           friction = F_c (1 + 0.05 exp(-(v_m / v_s)^2)) sign(v_m), and it sticks (Stribeck)
///   pulley: u = home + d + (1 + g) (m - home) + A sin(N m + phi) + c (m - middle)^2
///               - z + e + coupling,   rho = du/dm
///   cable:  F = k_c dz(u - q) + c_c (du/dt - v_q) where it is taut, else 0;
///           dz(x) = x -+ w/2 outside |x| <= w/2, else 0; a slack cable does not push
///   creep:  de/dt = (a (1 + F / F_0) - e) / T     (Kelvin-Voigt element under the pretension F_0)
///   z:      dz/du = 1 - |z / (w_b/2)|^n (1 + sign(du z)) / 2                (Bouc-Wen; |z| <=
///   w_b/2) link:   J_q dv_q/dt = F + load - b v_q - friction_q(v_q)                (Coulomb,
///   sticks)
///
/// Source: Armstrong-Helouvry et al. 1994, doi:10.1016/0005-1098(94)90209-7 (friction); Ismail et
/// al. 2009, doi:10.1007/s11831-009-9031-8 (Bouc-Wen)
struct JointPhysics {
  double home = 0.0;  ///< homing position [rad]
  // motor and controller
  double motor_inertia = 0.0;         ///< J_m [kg m^2]
  double stiffness = 0.0;             ///< k_p [Nm/rad]
  double damping = 0.0;               ///< k_d [Nm s/rad]
  double motor_viscous = 0.0;         ///< [Nm s/rad]
  double motor_friction = 0.0;        ///< F_c [Nm]
  double stribeck_speed = 1e-3;       ///< v_s [rad/s]
  double friction_waviness = 0.0;     ///< F_c is 1 + this sin(N_f m) times as large [-]
  double friction_wave_number = 0.0;  ///< N_f [1/rad]
  double no_load_speed = 0.0;         ///< v_0; 0 stands for none [rad/s]
  double stall_force = 0.0;           ///< F_s [Nm]
  // pulleys and cable
  double homing_error = 0.0;          ///< d [rad]
  double radius_error = 0.0;          ///< g, of the pulleys' radius ratio [-]
  double ripple = 0.0;                ///< A [rad]
  double ripple_number = 0.0;         ///< N [1/rad]
  double ripple_phase = 0.0;          ///< phi [rad]
  double curvature = 0.0;             ///< c [1/rad]
  double middle = 0.0;                ///< [rad]
  double play = 0.0;                  ///< w [rad]
  double cable_stiffness = 0.0;       ///< k_c [Nm/rad]
  double cable_damping = 0.0;         ///< c_c [Nm s/rad]
  double pretension = 1.0;            ///< F_0 > 0 [Nm]
  double creep = 0.0;                 ///< a [rad]
  double creep_time = 0.0;            ///< T; 0 stands for at once [s]
  double hysteresis_width = 0.0;      ///< w_b [rad]
  double hysteresis_sharpness = 1.0;  ///< n >= 1; a play of width w_b in the limit of large n
  // link
  double link_inertia = 0.0;    ///< J_q [kg m^2]
  double joint_viscous = 0.0;   ///< b [Nm s/rad]
  double joint_friction = 0.0;  ///< [Nm]
  double load_share = 1.0;      ///< of gravity that is not counterbalanced, 0..1 [-]
};

/// Physics without any hidden effect: a residual lag (k_d + b) / k_p of 12 us, and stretch and
/// friction far below 0.05 mm at the tool of a Raven.
JointPhysics cleanJoint(bool revolute, double home) noexcept;

/// State of one joint, moved step by step. Linearly implicit, so stiff cables and controllers need
/// no smaller step; sticking and slipping are solved exactly within a step.
class JointDrive {
 public:
  /// At rest at the set-point, every play in its middle.
  JointDrive(const JointPhysics& physics, double setpoint) noexcept;

  void setSetpoint(double r) noexcept { setpoint_ = r; }
  /// @param h         duration, > 0 [s]
  /// @param load      of gravity, positive along +q [Nm or N]
  /// @param coupling  how much other joints pull this cable [rad or m]
  /// @param creeping  the session has begun, so the cable settles
  void step(double h, double load, double coupling, bool creeping) noexcept;

  double setpoint() const noexcept { return setpoint_; }
  double motor() const noexcept { return m_; }  ///< what the encoder reports, in joint units
  double joint() const noexcept { return q_; }
  double cableForce() const noexcept { return force_; }

 private:
  struct Velocities {
    double motor, joint;
  };
  struct Contact {  // of the cable: force = constant + gain (rho v_m - v_q)
    double constant, gain;
  };
  double pulley(double m) const noexcept;
  double pulleySlope(double m) const noexcept;
  double motorFriction() const noexcept;
  Velocities solve(double h, double load, double rho, const Contact& contact) noexcept;
  Velocities stickSlip(double a11, double a12, double a22, double b1, double b2, double f1,
                       double f2) noexcept;
  void bendHysteresis(double du) noexcept;

  JointPhysics physics_;
  double setpoint_;
  double m_, v_m_ = 0.0;
  double q_, v_q_ = 0.0;
  double strain_ = 0.0;      // e
  double hysteresis_ = 0.0;  // z
  double force_ = 0.0;       // F
  int slip_ = 0;             // which of the nine cases of stick and slip held last
};

}  // namespace raven_correction::plant
