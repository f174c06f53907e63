// SPDX-License-Identifier: BSD-3-Clause
// What one delay of everything would explain of a residual. The other kinds of dependence are
// dependence.cpp.
#pragma once

#include "observed_samples.h"

namespace raven_correction {

struct DelayPrediction {
  Eigen::MatrixXd predictions;  ///< one row per sample, of its residual
  double delay = 0.0;           ///< of all motions [s]
};

/// residual = offset - delay * velocity, with one offset per component. Robust: Huber's weights,
/// from a fit to all motions; then every motion is predicted from those of the other folds.
/// @param residual  samples x components, each in units of its channel's scale
/// @param velocity  simulatedVelocity() of every sample, in the same units per second
DelayPrediction delayPredictions(const std::vector<ObservedSample>& samples,
                                 const Eigen::MatrixXd& residual, const Eigen::MatrixXd& velocity,
                                 int folds);

}  // namespace raven_correction
