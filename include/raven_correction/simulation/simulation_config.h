// SPDX-License-Identifier: BSD-3-Clause
// A simulation as plain data: the robot, what is wrong with it, and what watches it. Read from and
// written to config/simulation/*.yaml; its effect parameters can be taken out as one flat vector.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <string>
#include <vector>

#include "raven_correction/robot/cable_coupling.h"
#include "raven_correction/robot/kinematic_chain.h"
#include "raven_correction/simulation/debridement_motion.h"
#include "raven_correction/simulation/effect.h"
#include "raven_correction/simulation/gripper.h"
#include "raven_correction/simulation/motion_capture.h"

namespace raven_correction {

/// How a set-point is made between two commands.
enum class SetpointMode {
  kHold,    ///< the last one is held, as a robot does that cannot see into the future
  kLinear,  ///< straight in joints between two commands; for fits, which need smooth derivatives
};

struct SimulationConfig {
  std::string name;
  std::string description;
  std::string robot_file;  ///< path of the robot's YAML as it was written in the simulation file
  KinematicChain robot;    ///< nominal: what the controller believes
  double step = 1e-3;      ///< longest internal step [s], in (0, 0.1]
  double encoder_rate = 50.0;  ///< of measured_cp and measured_js in simulated sessions [Hz]
  CableCoupling coupling;      ///< of the robot's file; empty if that has none
  /// Encoders count in whole steps: measured_js and measured_cp have the resolution of the robot.
  bool quantise_encoders = false;
  SetpointMode setpoints = SetpointMode::kHold;
  std::vector<std::shared_ptr<const Effect>> effects;  ///< each at most once, in acting order
  /// Start stamps of the trajectories that its effects were fitted to [s]: on these it cannot be
  /// judged. Empty: not known.
  std::vector<double> fitted_to;
  MotionCaptureConfig motion_capture;
  GripperConfig gripper;
  DebridementConfig debridement;

  /// The effect of this name, or null.
  const Effect* find(const std::string& effect_name) const noexcept;
  /// Adds the effect in its place, or replaces the one of the same name.
  void set(std::unique_ptr<Effect> effect);
  void remove(const std::string& effect_name);
};

/// @param path  YAML; a robot file is looked for in ../robots/ of its folder, then beside it
/// @throws InvalidInput  one text that lists every problem, its place and what is allowed
SimulationConfig loadSimulationConfig(const std::string& path);
/// Writes a file that loadSimulationConfig() reads back to the same simulation, bit for bit.
/// @throws InvalidInput  the file cannot be written
void saveSimulationConfig(const SimulationConfig& config, const std::string& path);

/// A simulation as text that needs no other file: what a model of the correction carries.
struct SimulationTexts {
  std::string simulation;  ///< YAML, as saveSimulationConfig() writes it
  std::string robot;       ///< YAML of its robot file, as it is
};
/// @throws InvalidInput  the robot file cannot be read
SimulationTexts simulationTexts(const SimulationConfig& config);
/// The same simulation, bit for bit.
/// @param name  stands for the file in messages
/// @throws InvalidInput  as loadSimulationConfig()
SimulationConfig simulationFromTexts(const SimulationTexts& texts, const std::string& name);

/// Labels of all effect parameters, "drive_friction.w[shoulder]", in the order of
/// parameterVector().
std::vector<std::string> parameterLabels(const SimulationConfig& config);
/// All parameters of all effects, effect by effect.
std::vector<EffectParameter> parameterList(const SimulationConfig& config);
/// Their values.
Eigen::VectorXd parameterVector(const SimulationConfig& config);
/// The same simulation with these values.
/// @throws InvalidInput  wrong size, or a value out of its range
SimulationConfig withParameters(const SimulationConfig& config, const Eigen::VectorXd& values);

}  // namespace raven_correction
