// SPDX-License-Identifier: BSD-3-Clause
// Table II of the paper through the real nodes: planner, recorder, trainer, corrector and the
// simulated robot, called as a user calls them. The statistics are evaluation/repeatability.h.
#pragma once

#include <cstdint>
#include <string>

#include "raven_correction/correction/training.h"
#include "raven_correction/report/repeatability_report.h"

namespace raven_correction {

struct RepeatabilityParams {
  unsigned poses = 10;          ///< random fragment poses, >= 1
  unsigned visits = 10;         ///< of each of them, in each condition, >= 1
  unsigned trajectories = 240;  ///< motions that are recorded to learn from, >= 3
  std::uint32_t seed = 1;       ///< of poses, orders, motions and noise
  double clock_rate = 3.0;      ///< simulated seconds per real second, at most, > 0
  double turn = 0.35;  ///< deviation of the orientations that are learnt from, see RunPlanner [rad]
  double margin = 0.025;   ///< by which the field that is learnt from is larger, see RunPlanner [m]
  bool play = true;        ///< models know from which side each joint has come
  std::string folder;      ///< exists; bags, model and the nodes' log are written there
  std::string simulation;  ///< simulation file; empty: that of demo.launch
  std::string configuration;  ///< of the trainer; empty: config/trainer.yaml
};

/// @throws InvalidInput  a parameter is out of its range, or names a file that is not there
void checkRepeatability(const RepeatabilityParams& params);

/// Without correction; learn from other motions, without correction; corrected, every pose of the
/// trajectory; corrected at its endpoints only. The same visits in the same order each time.
/// @throws InvalidInput        see checkRepeatability()
/// @throws std::runtime_error  a node did not do what it was asked, or the process was interrupted;
///         nothing goes on running
RepeatabilityReport runRepeatability(const RepeatabilityParams& params, const Progress& progress);

}  // namespace raven_correction
