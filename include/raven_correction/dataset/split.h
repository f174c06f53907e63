// SPDX-License-Identifier: BSD-3-Clause
// Train/test splits. The trajectory is the unit: random splits of a time series leak, and flatter
// the model.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace raven_correction {

/// Fold `fold` of `folds`: of the trajectories 0, 1, 2, ... in order of start time, those with
/// index % folds == fold are for testing.
struct HoldOut {
  int fold = 0;
  int folds = 5;
  bool tests(std::size_t trajectory) const {
    return static_cast<int>(trajectory % static_cast<std::size_t>(folds)) == fold;
  }
};

/// "K/N" with 0 <= K < N.
/// @throws InvalidInput  for anything else
HoldOut parseHoldOut(const std::string& text);

}  // namespace raven_correction
