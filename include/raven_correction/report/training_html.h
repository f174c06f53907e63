// SPDX-License-Identifier: BSD-3-Clause
// A training run as a page with figures, for people. The same numbers as text and JSON are
// training_report.h.
#pragma once

#include <string>

#include "raven_correction/report/run_record.h"
#include "raven_correction/report/training_report.h"

namespace raven_correction {

/// One XHTML file: verdict, held-out errors, calibration, where was learnt and where to record
/// more, rigid step, physics and delay, hyper-parameters, cleaning, data health, provenance.
/// Numbers that are none become "n/a"; nothing throws but memory.
std::string trainingHtml(const TrainingResult& result, const TrainingPage& page,
                         const RunRecord& run);

}  // namespace raven_correction
