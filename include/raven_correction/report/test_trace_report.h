// SPDX-License-Identifier: BSD-3-Clause
// The correction along the motions of one fold (evaluation/test_trace.h) as text, as JSON, and as a
// page with the paper's Fig. 4.
#pragma once

#include <string>

#include "raven_correction/evaluation/test_trace.h"
#include "raven_correction/report/run_record.h"

namespace raven_correction {

std::string testTraceText(const TraceResult& result);

/// {"states", "clean_states", "test_trajectories", "n_train", "delay_s", "errors": {"none",
/// "rigid", "full": {"mean_abs_mm": [x, y, z], "position_norm_mm", "angle_norm_deg"}}, "trace":
/// {"trajectory": [...], "x_mm", "y_mm", "z_mm": {"command", "observed", "rigid", "full", "sd":
/// [...]}}}
std::string testTraceJson(const TraceResult& result);

/// One XHTML file: verdict, errors, the traces, what the model leaves of them, provenance.
std::string testTraceHtml(const TraceResult& result, const RunRecord& run);

}  // namespace raven_correction
