// SPDX-License-Identifier: BSD-3-Clause
// The states a model is tested on: every observation with the motion that led to it, as the live
// corrector would have seen it, and the command that belongs to it. The dirty set holds all of
// them, the clean one those that a tracker and a robot can produce.
#pragma once

#include <vector>

#include "raven_correction/correction/motion.h"
#include "raven_correction/correction/predictor.h"
#include "raven_correction/dataset/trajectory.h"
#include "raven_correction/evaluation/error_metrics.h"

namespace raven_correction {

struct TestState {
  std::size_t trajectory = 0;  ///< index into the data set
  std::size_t row = 0;         ///< index into its observations
  Motion motion;               ///< pose and twists before G
  Pose command;                ///< interpolated at (stamp - delay)
  bool plausible = false;      ///< keeps all gates that need no model
};

/// Gates of the clean test set. The last two look at the error after the rigid step.
struct CleanGates {
  double max_step = 0.15;                          ///< since the observation before [s]
  double max_speed = 0.4;                          ///< causal velocity of the observation [m/s]
  double max_angular_speed = 6.0;                  ///< [rad/s]
  double max_position_residual = 0.05;             ///< [m]
  double max_angle_residual = 0.7853981633974483;  ///< 45 deg [rad]
};

/// Every observation that is finite and has a command at its instant minus the delay (over gaps of
/// any length), but identity commands leave their stream first. `plausible` are those that do not
/// repeat the one before, whose commands are not further apart than max_gap and which keep the
/// gates on step and speed.
/// @param delay    observation behind command [s]
/// @param max_gap  longest interval of commands in a plausible state [s]
std::vector<TestState> makeTestStates(const Dataset& dataset, const MotionOptions& motion,
                                      double delay, double max_gap, const CleanGates& gates);

/// Which of the states form the clean test set: plausible, and with an error after the rigid step
/// within the gates.
std::vector<bool> cleanStates(const std::vector<TestState>& states, const Pose& rigid,
                              const CleanGates& gates);

/// What is said of the command of a state: nothing (none), G, or F.
enum class PredictionKind { kNone, kRigid, kFull };
/// Error of every state. @param predictor  not used, and may be null, for kNone
std::vector<PoseError> errorsOf(const std::vector<TestState>& states, PredictionKind kind,
                                const Predictor* predictor);

/// The errors that `chosen` picks.
std::vector<PoseError> pick(const std::vector<PoseError>& errors, const std::vector<bool>& chosen);

}  // namespace raven_correction
