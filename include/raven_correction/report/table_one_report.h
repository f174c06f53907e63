// SPDX-License-Identifier: BSD-3-Clause
// Table I as text for a terminal, beside the paper's numbers, and as JSON. The numbers are made in
// evaluation/table_one.h.
#pragma once

#include <string>

#include "raven_correction/evaluation/table_one.h"

namespace raven_correction {

/// Both test sets of every configuration, columns as in the paper, the paper's own table beside
/// them, then the norms fold by fold, the delay and what cleaning did. mm and deg.
std::string tableOneText(const TableOneResult& result);

/// {"rows": [{"configuration", "method", "test_set", "fold", "mean_abs": {"tx_mm", "ty_mm",
/// "tz_mm", "yaw_deg", "pitch_deg", "roll_deg"}, "std": {...}, "position_norm_mm",
/// "angle_norm_deg", "position_median_mm", "position_p95_mm", "position_norm_paper_mm",
/// "angle_mean_deg", "coverage95": {"dx", "dy", "dz", "rx", "ry", "rz"}, "nlpd": {...} (both with a
/// process only), "n_test", "n_train"}], "delay_s", "cleaning": {"total", "kept", "rejected":
/// {reason: count}, "identity_commands"}}
std::string tableOneJson(const TableOneResult& result);

}  // namespace raven_correction
