// SPDX-License-Identifier: BSD-3-Clause
// What a training run found, as text for a terminal and as JSON. The run is correction/training.h,
// the same as a page with figures training_html.h.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "raven_correction/correction/training.h"
#include "raven_correction/dataset/stream_finding.h"
#include "raven_correction/dataset/stream_health.h"
#include "raven_correction/evaluation/validated_training.h"
#include "raven_correction/evaluation/workspace_coverage.h"

namespace raven_correction {

/// How good the model is, and where: what a page shows beside the training itself.
struct TrainingPage {
  std::string model_file;
  HeldOutErrors held_out;  ///< of trajectories that the judged model's fit has not seen
  std::string judged;      ///< which model was judged on which trajectories, a sentence
  std::optional<SimulationOverlap> overlap;  ///< of the simulation with them; empty: not looked
  WorkspaceCoverage coverage;
  std::vector<StreamHealth> streams;
  std::vector<StreamFinding> findings;  ///< of the checks of the streams
};

/// Whether the errors on trajectories left out are errors on trajectories not seen: a simulation
/// knows those that it was diagnosed from. A sentence; empty where physics is not the mean.
std::string physicsCaveat(const TrainingResult& result, const TrainingPage& page);
/// Nothing of the model has seen the trajectories that it was judged on.
bool isJudgedFairly(const TrainingResult& result, const TrainingPage& page);

/// Data, cleaning, rigid step, physics, kernels; held-out errors where there is a page. mm and deg.
std::string trainingText(const TrainingResult& result, const TrainingPage* page = nullptr);

/// {"model": file, "id", "delay_s", "cleaning": {"total", "kept", "rejected": {reason: count},
/// "identity_commands", "least_median_scale_mm"}, "rigid": {"rms_position_mm", "rms_angle_deg"},
/// "physics": {"simulation", "rms_position_mm", "rms_angle_deg", "out_of_reach"} (only with it),
/// "n_train", "trajectories", "process": {"rows", "rows_used", "seconds_hyperparameters",
/// "seconds_posterior", "groups": [{"outputs", "log_marginal_likelihood", "converged", "message",
/// "noise_sd", "signal_sd", "length_scales"}]}}
/// and with a page: "held_out": {"judged", "n", "none", "rigid", "full": {"position_norm_mm",
/// "position_median_mm", "position_p95_mm", "angle_norm_deg", "angle_mean_deg"},
/// "coverage95": [dx, dy, dz, rx, ry, rz] (share within the predicted 95 % intervals; null where
/// nothing was predicted)}, "coverage": {"cell_mm", "cells", "covered", "record_more": [{"x_mm",
/// "y_mm", "z_mm", "commands", "kept", "trajectories"}]}
std::string trainingJson(const TrainingResult& result, const std::string& model_file,
                         const TrainingPage* page = nullptr);

}  // namespace raven_correction
