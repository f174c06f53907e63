// SPDX-License-Identifier: BSD-3-Clause
// The debridement experiment of the paper through the real nodes: simulator, recorder, trainer,
// corrector, stereo camera and detector on a ROS master of its own, and the task in this process.
// The statistics are evaluation/debridement_trial.h.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "raven_correction/correction/training.h"
#include "raven_correction/report/debridement_report.h"

namespace raven_correction {

struct DebridementParams {
  unsigned fragments = 60;    ///< at least, in each condition, >= 1
  unsigned arms = 2;          ///< 1 or 2
  unsigned rehearsals = 120;  ///< places of which each arm learns in the end, >= 5
  unsigned attempts = 4;      ///< until a fragment is given up, >= 1
  std::uint32_t seed = 1;     ///< of scenes, rehearsals and noise
  double clock_rate = 3.0;    ///< simulated seconds per real second, at most, > 0
  /// Of the condition that replans by itself [m]; 0: DebridementLearning::usual_prediction.
  double deviation_limit = 0.0;
  std::vector<std::string> conditions;  ///< some of the three; empty: all
  std::string folder;  ///< exists; bags, models, grasps.csv and the nodes' log are written there
  std::string configuration;  ///< of the trainer; empty: config/trainer.yaml
};

/// @throws InvalidInput  a parameter is out of its range, or names a file that is not there
void checkDebridement(const DebridementParams& params);

/// @throws InvalidInput        see checkDebridement()
/// @throws std::runtime_error  a node did not do what it was asked, or the process was interrupted;
///         nothing goes on running
DebridementReport runDebridement(const DebridementParams& params, const Progress& progress);

}  // namespace raven_correction
