// SPDX-License-Identifier: BSD-3-Clause
// How far the observation lags behind the command, from the data: the shift at which a rigid
// transform explains the positions best. synchronisation.h applies it.
#pragma once

#include <vector>

#include "raven_correction/dataset/trajectory.h"

namespace raven_correction {

struct DelayProblem {
  double min = 0.0;              ///< smallest delay tried [s]
  double max = 0.4;              ///< largest delay tried [s]
  double step = 0.01;            ///< of the search, refined by a parabola [s]
  std::size_t max_pairs = 4000;  ///< observations used, evenly spread
  double max_gap = 0.1;          ///< longest interval of commands bridged [s]
};

struct DelayResult {
  enum class Status {
    kNotRun,
    kOk,
    kNotObservable,  ///< too few pairs, or hardly any motion: every delay explains them equally
    kAtLimit,        ///< the best delay is the smallest or largest that was tried
  };
  Status status = Status::kNotRun;
  double delay = 0.0;            ///< observation behind command [s]; 0 unless kOk or kAtLimit
  std::vector<double> tried;     ///< delays [s]
  std::vector<double> residual;  ///< median position residual after the rigid fit, per delay [m]
  std::size_t pairs = 0;         ///< observations used
};

/// "estimated", or what is wrong and what to do about it.
const char* delayStatusText(DelayResult::Status status) noexcept;

/// For each delay: the rigid transform (positions only) fitted to the half of the pairs that it
/// explains best (concentration steps, so that outliers do not pull it), scored by the median of
/// all residuals. The same observations are used for every delay.
/// @throws InvalidInput  min >= max, or a step or a gap that is not positive
/// Source of the concentration step: Rousseeuw, Van Driessen 2006, doi:10.1007/s10618-005-0024-4
DelayResult estimateDelay(const Dataset& dataset, const DelayProblem& problem);

}  // namespace raven_correction
