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

/// heldOutResiduals() as far as the derivatives at the fit tell, without any simulation: right for
/// causes that are small, and good enough to see which of many are.
class LinearHeldOut {
 public:
  /// @param problem, fit  as for heldOutResiduals(); referred to
  LinearHeldOut(const EffectFitProblem& problem, const EffectFit& fit, int folds);
  /// A cause that is dropped: its parameters are `count` of the fit's, from `first`; the first
  /// `amplitudes` of these become 0, the others shape what is not there any more.
  struct Dropped {
    Eigen::Index first = 0, amplitudes = 0, count = 0;
  };
  /// The held-out residual with all other parameters free to make up for it within their ranges;
  /// with nothing dropped, that of the fit. @return layout.size numbers
  Eigen::VectorXd residual(const Dropped& dropped) const;
  Eigen::VectorXd residual() const { return residual(Dropped()); }
  /// Where the other parameters go then, with no fold held out; those of the cause go with it.
  /// Within their ranges. @return one for each parameter that is left
  Eigen::VectorXd others(const Dropped& dropped) const;

 private:
  Eigen::VectorXd step(const NormalEquations& equations, const Dropped& dropped) const;

  const EffectFitProblem& problem_;
  const EffectFit& fit_;
  std::vector<NormalEquations> without_;  // each fold
};

/// Whether `after` is better than `before`, motion by motion: with n motions and
/// d_i = before_i - after_i,
///
///   z_mean    = mean(d) / (sd(d) / sqrt(n))
///   z_typical = mean(d) / (1.4826 median|d_i - median(d)| / sqrt(n))
///
/// The second has a robust deviation below: an effect that shows in few motions makes their d large
/// and sd(d) with it, and must not count as noise. Its tails are heavier than Student's.
/// Source of the robust deviation: Hampel 1974, doi:10.1080/01621459.1974.10482962
struct LossComparison {
  double share = 0.0;  ///< mean(before - after) / mean(before) [-]
  double lower = 0.0;  ///< 95 % interval of the share, by bootstrap over motions
  double upper = 0.0;
  double z_mean = 0.0;     ///< mean difference over its standard error [-]
  double z_typical = 0.0;  ///< the same over the spread of the typical motion [-]
};
/// @param before, after  one loss per motion (motionLosses()); a motion with nan in either is left
///        out
/// @param seed           of the bootstrap
/// @param resamples      of the bootstrap; 0: no interval, its ends stay 0
/// @return all zero for fewer than two motions, or where mean(before) is not above 0
LossComparison compareLosses(const Eigen::VectorXd& before, const Eigen::VectorXd& after,
                             std::uint64_t seed, int resamples = 1000);

}  // namespace raven_correction
