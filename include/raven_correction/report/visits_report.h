// SPDX-License-Identifier: BSD-3-Clause
// Before and after a correction, at rest on the same targets: a table for people, JSON for
// programs. The numbers are made in evaluation/visits.h.
#pragma once

#include <string>

#include "raven_correction/evaluation/visits.h"

namespace raven_correction {

/// Per axis and norm, before | after | ratio, mm and deg; then the worst visit of each.
std::string visitsText(const VisitComparison& comparison);

/// {"before": {"position_norm_mm", "angle_norm_deg", "mean_abs": {...}, "std": {...},
/// "position_median_mm", "position_p95_mm"}, "after": {...}, "targets", "skipped", "bag", "model"}
/// @param bag, model  file names, for the record; may be empty
std::string visitsJson(const VisitComparison& comparison, const std::string& bag,
                       const std::string& model);

}  // namespace raven_correction
