// SPDX-License-Identifier: BSD-3-Clause
// Training as the trainer node does it: one fifth of the trajectories is kept out of the fit,
// always the same ones, and the model has to prove itself on them before it goes live. Tables over
// all folds are table_one.h.
#pragma once

#include <optional>
#include <vector>

#include "raven_correction/correction/training.h"
#include "raven_correction/evaluation/simulation_overlap.h"
#include "raven_correction/evaluation/test_states.h"

namespace raven_correction {

/// Errors of a model on the clean states of trajectories that it was not fitted to, one by one.
struct HeldOutErrors {
  std::vector<PoseError> none, rigid, full;  ///< the same states
};
/// Deployed models see the past only, also where they were trained with the central stencil.
/// @param max_gap  longest interval of commands bridged [s]
/// @throws InvalidInput  no state passes the gates of the clean set
HeldOutErrors heldOutErrors(const Correction& model, const Dataset& held_out, double max_gap);

struct ValidatedTraining {
  TrainingResult training;  ///< fitted without the held-out trajectories; held_out is filled in
  std::size_t held_out_trajectories = 0;
  ErrorSummary none, rigid, full;            ///< on the clean held-out states
  HeldOutErrors errors;                      ///< that they are the summaries of
  std::optional<ErrorSummary> live;          ///< the model that is live now, on the same states
  std::optional<SimulationOverlap> overlap;  ///< of the simulation that is the mean, if one is
  bool better = false;                       ///< may replace the live model (or no correction)
  std::string verdict;                       ///< the comparison in one sentence
};

/// Whether a trajectory is kept out of every fit: decided by its start stamp alone, so that a
/// trajectory that once validated a model never trains a later one. About one in five.
bool isHeldOut(const Trajectory& trajectory) noexcept;

/// What is learnt from, and what is kept out of every fit: as isHeldOut() says; where that would
/// hold out no trajectory, or leave fewer than two to learn from, every fifth one by start time is
/// held out instead.
struct ValidationSplit {
  Dataset training, held_out;
};
ValidationSplit splitForValidation(const Dataset& dataset);

/// Trains on one part of splitForValidation(), and judges on the other. A model is better when the
/// mean of the ratios of its position and angle norms to those of the live model (or to no
/// correction) is below 1, and its simulation, where it has one, was fitted to none of the
/// trajectories that it is judged on, as far as the simulation says.
/// @param live  model in use, or null
/// @throws InvalidInput  fewer than three trajectories, no clean held-out state, or see train()
ValidatedTraining trainAndValidate(const Dataset& dataset, const TrainingConfig& config,
                                   const Correction* live, double now,
                                   const Progress& progress = {});

}  // namespace raven_correction
