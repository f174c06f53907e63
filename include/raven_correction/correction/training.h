// SPDX-License-Identifier: BSD-3-Clause
// From recorded trajectories to the model F = H o G: synchronise, clean, fit G, learn H. How good a
// model is on data it has not seen is the room `evaluation`.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "raven_correction/correction/model.h"
#include "raven_correction/correction/training_config.h"
#include "raven_correction/dataset/split.h"

namespace raven_correction {

/// What is going on, for people who wait. fraction: of the whole, 0 to 1.
using Progress = std::function<void(const std::string& phase, double fraction)>;

/// Pairs that can be learnt from, before cleaning.
struct TrainingPairs {
  std::vector<CleaningSample> samples;
  std::vector<Motion> motions;  ///< of the observations, same order
  FateCounts fates;             ///< of all observation samples; kept = samples.size()
  std::size_t identity_commands = 0;
  std::vector<PoseStream> observations;  ///< by trajectory, those without a command, too
  std::vector<std::size_t> rows;         ///< of each sample in its trajectory's observations
};

/// Synchronised pairs with the motion of each observation.
/// @throws InvalidInput  see synchronise()
TrainingPairs makePairs(const Dataset& dataset, const TrainingConfig& config, double delay);

/// Follows the play of the pairs' motions anew, past what cleaning takes for a fault of motion
/// capture: one wrong frame turns joints far past their play, and leaves them on its wrong side
/// until each has moved that far. Live there are no such frames, as commands are followed.
/// @param fates  of the pairs, same order
void followPlayWithoutOutliers(TrainingPairs& pairs, const std::vector<Fate>& fates,
                               const MotionOptions& options);

/// Where the tool was seen in one pair, and what cleaning made of it.
struct PlacedSample {
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  ///< observed, base frame [m]
  Fate fate = Fate::kKept;
};

/// Longest interval of commands that the configuration bridges in this data set [s], see
/// SynchronisationOptions; 0 without commands.
double commandGapLimit(const Dataset& dataset, const TrainingConfig& config);

struct TrainingResult {
  Correction model;
  std::vector<PlacedSample>
      samples;        ///< every pair, in order; what has no command is not among them
  DelayResult delay;  ///< kNotRun where the delay was fixed
  FateCounts fates;   ///< of every observation sample: synchronisation and cleaning
  std::size_t identity_commands = 0;
  double least_median_scale = 0.0;    ///< robust deviation of the rigid residual [m]
  double rigid_rms_position = 0.0;    ///< on the kept pairs [m]
  double rigid_rms_angle = 0.0;       ///< on the kept pairs [rad]
  std::string simulation;             ///< name of the one that is the mean; empty: none, as below
  std::size_t out_of_reach = 0;       ///< kept pairs that its robot does not reach: not learnt from
  double physics_rms_position = 0.0;  ///< of what it leaves to the process, on the others [m]
  double physics_rms_angle = 0.0;     ///< [rad]
  GpFitReport process;
};

/// @param now  Unix time that goes into the model's id [s]
/// @throws InvalidInput  nothing to learn from: no pairs, or all of them rejected (the text says
/// for
///         which reasons, and the remedy); a configuration out of range; or a simulation of another
///         robot (physicsOf()), or one that reaches less than half of the poses
TrainingResult train(const Dataset& dataset, const TrainingConfig& config, double now,
                     const Progress& progress = {});

/// The trajectories of the data set that the fold does not test on (`tests` false), or those that
/// it does (`tests` true).
Dataset selectFold(const Dataset& dataset, const HoldOut& hold_out, bool tests);

/// "12 kept; rejected: 3 speed, 1 repeated".
std::string describe(const FateCounts& fates);

}  // namespace raven_correction
