// SPDX-License-Identifier: BSD-3-Clause
// Table I as a page with figures, for people. The same numbers as text and JSON are
// table_one_report.h.
#pragma once

#include <string>
#include <vector>

#include "raven_correction/dataset/stream_health.h"
#include "raven_correction/evaluation/error_samples.h"
#include "raven_correction/report/run_record.h"

namespace raven_correction {

/// One XHTML file: verdict, Table I beside the paper's, folds, error distributions, calibration,
/// cleaning, data health, provenance.
/// @param samples  the errors of the same run; the configuration the verdict is about is the last
///                 of the table
/// @throws InvalidInput  a row of the table is missing, or `samples` are not of this table
std::string tableOneHtml(const TableOneResult& result, const ErrorSamples& samples,
                         const std::vector<StreamHealth>& streams, const RunRecord& run);

}  // namespace raven_correction
