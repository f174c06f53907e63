// SPDX-License-Identifier: BSD-3-Clause
// How regularly the streams of a recording were sampled: rates, gaps, repeated and impossible
// samples. What a session's errors are like is simulation/session_statistics.h.
#pragma once

#include <string>
#include <vector>

#include "raven_correction/dataset/trajectory.h"

namespace raven_correction {

/// One stream over all trajectories. Intervals are those between samples of one trajectory with
/// different stamps.
struct StreamHealth {
  std::string stream;            ///< "commands", "observations", "encoders", "joint commands", ...
  std::size_t trajectories = 0;  ///< that have samples of it
  std::size_t samples = 0;
  std::size_t repeated = 0;    ///< same stamp as the sample before, or exactly the same values
  std::size_t not_finite = 0;  ///< a coordinate is nan or infinite
  double duration = 0.0;       ///< sum over trajectories of last minus first stamp [s]
  double period_median = 0.0;  ///< [s]; 0 without intervals
  double period_p95 = 0.0;     ///< [s]
  double longest_gap = 0.0;    ///< [s]
  std::string longest_in;      ///< the trajectory it is in
  double gap_share = 0.0;      ///< of the duration that lies in intervals above 3 medians [-]
};

/// Streams without any sample are left out.
std::vector<StreamHealth> streamHealth(const Dataset& dataset);

}  // namespace raven_correction
