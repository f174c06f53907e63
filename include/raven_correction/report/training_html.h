// SPDX-License-Identifier: BSD-3-Clause
// A training run as a page with figures, for people. The same numbers as text and JSON are
// training_report.h.
#pragma once

#include <string>
#include <vector>

#include "raven_correction/dataset/stream_health.h"
#include "raven_correction/evaluation/validated_training.h"
#include "raven_correction/evaluation/workspace_coverage.h"
#include "raven_correction/report/run_record.h"

namespace raven_correction {

/// What a training page shows beside the training itself.
struct TrainingPage {
  std::string model_file;
  HeldOutErrors held_out;  ///< of trajectories that the judged model has not seen
  std::string judged;      ///< which model was judged on which trajectories, a sentence
  WorkspaceCoverage coverage;
  std::vector<StreamHealth> streams;
};

/// One XHTML file: verdict, held-out errors, calibration, where was learnt and where to record
/// more, rigid step and delay, hyper-parameters, cleaning, data health, provenance.
std::string trainingHtml(const TrainingResult& result, const TrainingPage& page,
                         const RunRecord& run);

}  // namespace raven_correction
