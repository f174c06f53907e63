// SPDX-License-Identifier: BSD-3-Clause
// A robot that is not the simulation: joints of joint_drive.h at a small step, the chain as it
// really is, and what stands between the tool and motion capture. It shares the kinematic chain and
// the gravity load with room `robot`, and no code with room `simulation`.
#pragma once

#include <deque>
#include <string>
#include <vector>

#include "plant/joint_drive.h"
#include "raven_correction/robot/kinematic_chain.h"

namespace raven_correction::plant {

/// Physics outside of the catalogue that is not of one joint; see outside.h. 0 is absent.
struct OutsidePhysics {
  double thermal_amplitude = 0.0;  ///< of the shaft's length [m]
  double thermal_period = 30.0;    ///< [s]
  double shaft_wave = 0.0;  ///< lateral, in waves along the insertion, turns with the roll [m]
  double shaft_wave_length = 0.04;  ///< [m]
  double wobble = 0.0;              ///< lateral, eight times per turn of the roll [m]
  double distortion = 0.0;          ///< of the mocap volume, 5 cm from its middle [m]
  double sway = 0.0;                ///< of the table [m]
  double sway_frequency = 1.3;      ///< [Hz]
};

/// Cable `moved` is pulled by c (q_a - middle_a) (q_b - middle_b).
struct ProductCoupling {
  int moved = -1;  ///< -1 for none
  int a = 0;
  int b = 0;
  double c = 0.0;
  double middle_a = 0.0;
  double middle_b = 0.0;
};

struct RobotPhysics {
  KinematicChain nominal;            ///< what the controller believes
  KinematicChain chain;              ///< as it really is
  std::vector<JointPhysics> joints;  ///< in the order of the chain's rows
  /// c_ij: cable i runs over the pulley of joint j [-, rad/m or m/rad]. NxN, zero diagonal.
  Eigen::MatrixXd coupling;
  double delay = 0.0;        ///< of the queue of set-points [s]
  Pose X_base_robot;         ///< where the base really is
  Pose X_tool_markers;       ///< where the markers really are
  double bump_time = -1.0;   ///< since the start of the session; < 0 stands for never [s]
  Pose bump;                 ///< everything is seen displaced by this from then on
  double mocap_scale = 0.0;  ///< positions are (1 + this) times as large [-]
  Eigen::Vector3d volume_middle = Eigen::Vector3d::Zero();  ///< of the motions, in `base` [m]
  OutsidePhysics outside;
  ProductCoupling product;
};

/// The clean robot of a chain.
RobotPhysics cleanRobot(const KinematicChain& nominal);

class RobotPlant {
 public:
  static constexpr double kStep = 1e-4;       ///< longest step of integration [s]
  static constexpr double kFirstStep = 4e-6;  ///< the one after a set-point changed [s]

  /// At rest at these joints.
  /// @param now            [s]
  /// @param session_start  instant from which on cables creep and bumps are counted [s]
  RobotPlant(const RobotPhysics& physics, const JointVector& joints, double now,
             double session_start);

  /// Queues a set-point; stamps do not decrease.
  void command(double stamp, const JointVector& joints);
  /// Steps end where a set-point changes, so every instant is met exactly.
  void advanceTo(double time);

  double time() const noexcept { return time_; }
  JointVector setpoints() const;
  JointVector motors() const;  ///< as encoders report them, in joint units
  JointVector joints() const;
  Pose motorPose() const;     ///< nominal forward kinematics of motors()
  Pose observedPose() const;  ///< what a perfect camera sees, X_base_markers

 private:
  struct Queued {
    double stamp;
    JointVector joints;
  };
  void integrate(double end);
  Pose bentForward() const;

  RobotPhysics physics_;
  std::vector<JointDrive> drives_;
  std::deque<Queued> queue_;
  double time_;
  double session_start_;
  double changed_;  // when a set-point changed last
  double load_time_;
  JointVector load_;
  bool coupled_;
  std::vector<double> steps_;  // of the present interval [s]
};

}  // namespace raven_correction::plant
