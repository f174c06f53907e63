// SPDX-License-Identifier: BSD-3-Clause
// How well fitted effects predict motions that they were not fitted to, and whether one explanation
// does it better than another. The fit itself is effect_fit.h.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "raven_correction/diagnosis/effect_fit.h"

namespace raven_correction {

/// Residuals of every motion under parameters that were fitted without its fold; motion i belongs
/// to fold i % folds. From the fit to all motions, each fold's parameters are one Gauss-Newton step
/// away, theta - (H - H_k)^-1 (g - g_k), clipped to their ranges; then the simulation is run.
/// What is no parameter of the fit is not held out: which effects there are, and fixed shapes.
/// @param fit  of problem, with its Jacobian, to all motions
/// @param simulated  if not null: what the simulation of its fold says of every sample
/// @return layout.size numbers
/// Source of the step: Beirami et al. 2017, On optimal generalizability in parametric learning
Eigen::VectorXd heldOutResiduals(const EffectFitProblem& problem, const EffectFit& fit, int folds,
                                 SimulatedSamples* simulated = nullptr);

/// Whether `after` is better than `before`, motion by motion.
struct LossComparison {
  double share = 0.0;  ///< mean(before - after) / mean(before) [-]
  double lower = 0.0;  ///< 95 % interval of the share, by bootstrap over motions
  double upper = 0.0;
  double z_mean = 0.0;     ///< mean difference over its standard error
  double z_typical = 0.0;  ///< the same with the spread of the middle half of the motions: an
                           ///< effect that shows in few motions must not count as noise
};
/// @param before, after  one loss per motion (motionLosses()); nan is left out
LossComparison compareLosses(const Eigen::VectorXd& before, const Eigen::VectorXd& after,
                             std::uint64_t seed);

}  // namespace raven_correction
