// SPDX-License-Identifier: BSD-3-Clause
// How well fragments were found, as text for a terminal and as JSON. The numbers are made in
// evaluation/fragment_trial.h.
#pragma once

#include <string>

#include "raven_correction/evaluation/fragment_trial.h"

namespace raven_correction {

/// Counts, errors, calibration of the covariance, yaw, time: mm, deg, %, ms.
std::string fragmentText(const FragmentScore& score);

/// {"scenes", "fragments", "half_visible", "half_visible_found", "overlapped", "overlapped_found",
/// "detections", "false_detections", "displaced_detections", "found_percent", "within_1mm_percent",
/// "error_mm": {"median",
/// "p95", "largest"}, "normalised_error2", "inside_95_percent", "yaw": {"fragments",
/// "within_10deg_percent", "rms_normalised"}, "detection_ms": {"median", "p95"}}
std::string fragmentJson(const FragmentScore& score);

}  // namespace raven_correction
