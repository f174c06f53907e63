// SPDX-License-Identifier: BSD-3-Clause
// What a training run found, as text for a terminal and as JSON. The run is correction/training.h.
#pragma once

#include <string>

#include "raven_correction/correction/training.h"

namespace raven_correction {

/// Data, cleaning, rigid step, kernels. mm and deg.
std::string trainingText(const TrainingResult& result);

/// {"model": file, "id", "delay_s", "cleaning": {"total", "kept", "rejected": {reason: count},
/// "identity_commands", "least_median_scale_mm"}, "rigid": {"rms_position_mm", "rms_angle_deg"},
/// "n_train", "trajectories", "process": {"rows", "rows_used", "seconds_hyperparameters",
/// "seconds_posterior", "groups": [{"outputs", "log_marginal_likelihood", "converged", "message",
/// "noise_sd", "signal_sd", "length_scales"}]}}
std::string trainingJson(const TrainingResult& result, const std::string& model_file);

}  // namespace raven_correction
