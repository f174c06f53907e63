// SPDX-License-Identifier: BSD-3-Clause
// A verdict as a page with figures, for people. The same numbers as text and JSON are
// diagnosis_report.h.
#pragma once

#include <string>
#include <vector>

#include "raven_correction/dataset/stream_health.h"
#include "raven_correction/diagnosis/diagnose.h"
#include "raven_correction/report/run_record.h"

namespace raven_correction {

/// One XHTML file: verdict and what to do next, causes, the residual before and after in the tool
/// and in joints, what it depends on, what is left, data health, provenance.
/// @param extended  simulation file that was written; empty: none
std::string diagnosisHtml(const Verdict& verdict, const std::vector<StreamHealth>& streams,
                          const std::string& extended, const RunRecord& run);

}  // namespace raven_correction
