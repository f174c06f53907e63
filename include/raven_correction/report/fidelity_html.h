// SPDX-License-Identifier: BSD-3-Clause
// A simulated session beside the measured one as a page with figures, for people. The same numbers
// as text and JSON are fidelity_report.h.
#pragma once

#include <string>
#include <vector>

#include "raven_correction/dataset/stream_health.h"
#include "raven_correction/evaluation/fidelity.h"
#include "raven_correction/report/run_record.h"

namespace raven_correction {

/// One XHTML file: verdict, requirements, Table I measured and simulated, all figures side by side,
/// data health, provenance.
std::string fidelityHtml(const FidelityResult& result, const std::vector<StreamHealth>& streams,
                         const RunRecord& run);

}  // namespace raven_correction
