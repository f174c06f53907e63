// SPDX-License-Identifier: BSD-3-Clause
// The fit of gaussian_process.h for those who wait for it: how far it is, and a way to end it. The
// numbers are the same.
#pragma once

#include <functional>

#include "raven_correction/regression/gaussian_process.h"

namespace raven_correction {

/// Called from the fitting thread after every evaluation of the criterion and every posterior.
/// @param fraction  of the fit that is done, never falling, 0 to 1; how many evaluations a search
///        needs is not known before its end, so it slows down
/// What it throws ends the fit, and is thrown by it.
using FitProgress = std::function<void(double fraction)>;

/// As fitGp() of gaussian_process.h.
/// @throws InvalidInput  see there; or what `progress` throws
GpFit fitGp(const Eigen::MatrixXd& features, const Eigen::MatrixXd& targets, const GpConfig& config,
            const std::vector<int>& row_groups, const FitProgress& progress);

/// As learnHyperParameters() of hyperparameters.h.
/// @param evaluated  called after every evaluation of the criterion, unless it is empty
HyperParameterResult learnHyperParameters(const HyperParameterProblem& problem,
                                          const std::function<void()>& evaluated);

}  // namespace raven_correction
