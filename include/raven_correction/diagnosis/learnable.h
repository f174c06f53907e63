// SPDX-License-Identifier: BSD-3-Clause
// What a Gaussian process still learns from what the causes leave, on motions held out: how much a
// correction on top of the extended simulation can gain. Whether a few simple functions predict a
// part of it, and which, is dependence.h.
#pragma once

#include <cstdint>

#include "raven_correction/diagnosis/residual.h"

namespace raven_correction {

/// Each motion's residual without what a process learnt from the motions of the other folds
/// predicts of it. Features are those that a correction has live, taken from what drives the
/// simulation: simulated joints, and the mean speeds of the set-points over three intervals of the
/// past (to 0.05, 0.15 and 0.4 s), the last set-point held: what comes next is not known yet.
/// Components are clipped at three robust deviations to learn from, so that single wrong samples do
/// not rule; encoder channels stay as they are.
/// @param joints  of residuals(), one column per block
/// @return layout.size numbers; `residual` itself where a fold has nothing to learn from
Eigen::VectorXd withoutLearnable(const Recording& recording, const ResidualLayout& layout,
                                 const Eigen::VectorXd& residual, const Eigen::MatrixXd& joints,
                                 int folds, std::uint64_t seed);

}  // namespace raven_correction
