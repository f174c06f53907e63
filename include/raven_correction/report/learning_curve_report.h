// SPDX-License-Identifier: BSD-3-Clause
// The learning curves with and without physics (evaluation/learning_curve.h) as text and as JSON.
#pragma once

#include <string>

#include "raven_correction/evaluation/learning_curve.h"

namespace raven_correction {

std::string learningCurveText(const LearningCurveResult& result);

/// {"rows": [{"method", "pairs", "n_train", "n_test", "position_norm_mm", "position_median_mm",
/// "position_p95_mm", "angle_norm_deg", "angle_mean_deg", "fold_position_norm_mm": [...],
/// "fold_angle_norm_deg": [...]}], "saved": [{"pairs", "position_ratio",
/// "position_ratio_interval": [lo, hi], "angle_ratio", "angle_ratio_interval",
/// "regression_pairs_position", "regression_pairs_angle"}], "trajectories", "out_of_reach",
/// "simulations"}; the last two of saved are null where regression alone needs more pairs than the
/// curve has, and 0 where fewer than its fewest do.
std::string learningCurveJson(const LearningCurveResult& result);

}  // namespace raven_correction
