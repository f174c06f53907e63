// SPDX-License-Identifier: BSD-3-Clause
// The learning curves (evaluation/learning_curve.h) as text, as JSON, and those of regression alone
// as a page with the paper's Fig. 5.
#pragma once

#include <string>

#include "raven_correction/evaluation/learning_curve.h"
#include "raven_correction/report/run_record.h"

namespace raven_correction {

std::string learningCurveText(const LearningCurveResult& result);

/// {"rows": [{"method", "pairs", "n_train", "n_test", "position_norm_mm", "position_median_mm",
/// "position_p95_mm", "angle_norm_deg", "angle_mean_deg", "train_seconds", "fold_position_norm_mm":
/// [...], "fold_angle_norm_deg": [...]}], "saved": [{"pairs", "position_ratio",
/// "position_ratio_interval": [lo, hi], "angle_ratio", "angle_ratio_interval",
/// "regression_pairs_position", "regression_pairs_angle"}], "trajectories", "out_of_reach",
/// "simulations"}; the last two of saved are null where regression alone needs more pairs than the
/// curve has, and 0 where fewer than its fewest do.
std::string learningCurveJson(const LearningCurveResult& result);

/// One XHTML file: verdict, the curves of regression alone with the paper's training times beside
/// its own, the numbers, provenance.
std::string learningCurveHtml(const LearningCurveResult& result, const RunRecord& run);

}  // namespace raven_correction
