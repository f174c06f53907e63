// SPDX-License-Identifier: BSD-3-Clause
// The shipped training configuration made small enough for tests of reports.
#pragma once

#include "raven_correction/correction/training_config.h"

namespace raven_correction {

inline TrainingConfig quickTraining() {
  TrainingConfig config = loadTrainingConfig("config/trainer.yaml");
  config.process.criterion = HyperCriterion::kLikelihood;
  config.process.backend = GpBackend::kExact;
  config.process.max_hyper_points = 80;
  config.process.max_exact_points = 150;
  config.process.groups = {{0, 1, 2, 3, 4, 5}};
  config.process.ard = false;
  config.tie_vectors = false;
  return config;
}

}  // namespace raven_correction
