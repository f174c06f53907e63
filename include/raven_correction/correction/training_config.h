// SPDX-License-Identifier: BSD-3-Clause
// Everything that training can be told, and its YAML file. config/trainer.yaml is the package's
// best configuration, config/trainer_case2014.yaml the paper's; both explain every key.
#pragma once

#include <memory>
#include <string>

#include "raven_correction/cleaning/cleaning.h"
#include "raven_correction/correction/motion.h"
#include "raven_correction/dataset/delay.h"
#include "raven_correction/dataset/synchronisation.h"
#include "raven_correction/regression/gaussian_process.h"
#include "raven_correction/simulation/simulation_config.h"

namespace raven_correction {

struct TrainingConfig {
  std::string name = "default";  ///< for tables

  bool estimate_delay = true;    ///< from the training data; otherwise fixed_delay
  double fixed_delay = 0.0;      ///< observation behind command [s]
  double delay_max = 0.4;        ///< largest delay that the estimate tries [s]
  double max_gap = 0.0;          ///< see SynchronisationOptions [s]
  double max_gap_periods = 5.0;  ///< see SynchronisationOptions [-]

  MotionOptions motion;

  bool cleaning_enabled = true;  ///< false: every synchronised pair is learnt from
  CleaningOptions cleaning;

  double rotation_length = 0.05;  ///< of the rigid fit, see rigid_fit.h [m]

  bool process_enabled = true;  ///< false: the model is the rigid transform alone
  GpConfig process;
  /// The three components of a position, rotation vector, v or w share a length scale (kValidation
  /// with process.ard only).
  bool tie_vectors = false;

  double workspace_margin = 0.05;  ///< see TrustRegion [m]
  double fade_start = 0.8;         ///< see TrustRegion [-]
  double fade_end = 0.95;          ///< see TrustRegion [-]

  /// Physics as the mean (physics.h): its way back comes before the process; null: the rigid step.
  std::shared_ptr<const SimulationConfig> simulation;

  /// Of learning curves: learn from so many of the cleaned pairs only, drawn by process.seed; 0:
  /// all.
  std::size_t max_pairs = 0;
  enum class Draw {
    kPairs,         ///< one by one, from all trajectories
    kTrajectories,  ///< whole trajectories, in random order, until there are enough
  } draw = Draw::kPairs;

  std::string text;  ///< the YAML it was read from, for the record; empty when made in code
};

/// @throws InvalidInput  no such file, not YAML, or any unknown key, wrong type or value out of
///         range: one text that lists them all
TrainingConfig loadTrainingConfig(const std::string& file);

/// The motion knows the play of this robot's joints.
/// @throws InvalidInput  the robot file cannot be read, or its robot has not six joints
void knowRobot(const std::string& file, MotionOptions& motion);

}  // namespace raven_correction
