// SPDX-License-Identifier: BSD-3-Clause
// The correction at work, state by state along the motions of one fold: what was commanded, where
// the tool was seen, and which command the rigid step and the whole model say for that. What such
// errors come to over all folds is table_one.h.
// Source: Mahler et al. 2014, section V-B, Fig. 4
#pragma once

#include <vector>

#include "raven_correction/correction/training.h"
#include "raven_correction/evaluation/test_states.h"

namespace raven_correction {

struct TraceProblem {
  TrainingConfig config;
  HoldOut hold_out{0, 5};     ///< whose test trajectories are shown; the others are learnt from
  std::size_t states = 1000;  ///< at most so many clean test states, from the first on, >= 1
  CleanGates gates;
};

struct TraceState {
  std::size_t trajectory = 0;  ///< index among those that are held out
  Pose command;                ///< that led to the observation: the truth
  Pose observed;               ///< what the tool did; none of the methods: the uncorrected error
  Pose rigid;                  ///< command that G says
  Pose full;                   ///< command that F says
  Eigen::Vector3d sd_position = Eigen::Vector3d::Zero();  ///< of F, base frame [m]
};

struct TraceResult {
  std::vector<TraceState> states;     ///< in order of time
  ErrorSummary none, rigid, full;     ///< of these states
  std::size_t clean_states = 0;       ///< of the fold; `states` are the first of them
  std::size_t test_trajectories = 0;  ///< held out
  std::size_t n_train = 0;            ///< pairs learnt from
  double delay = 0.0;                 ///< observation behind command [s]
};

/// @throws InvalidInput  no states asked for, no test trajectory or no clean state in the fold, or
///         see train()
TraceResult testTrace(const Dataset& dataset, const TraceProblem& problem,
                      const Progress& progress = {});

}  // namespace raven_correction
