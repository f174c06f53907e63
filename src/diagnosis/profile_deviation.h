// SPDX-License-Identifier: BSD-3-Clause
// How well a recording knows a parameter that no gradient improves: the instant of a shift.
#pragma once

#include "raven_correction/diagnosis/claim.h"
#include "raven_correction/diagnosis/effect_fit.h"

namespace raven_correction {

/// Half the width of the interval over which the parameter may move until the log likelihood of the
/// fit (ClaimRule::logLikelihood()) falls by 1/2, with the fitted parameters following by their
/// derivatives: one standard deviation where the likelihood is that of a normal distribution. Where
/// it steps from sample to sample, the interval ends at the step.
/// @param problem  its simulation has the parameter, none of the fitted ones is it
/// @param fit      of the problem, with its Jacobian
/// @return not above half the width of its range; in the unit of the parameter
/// Source: Venzon, Moolgavkar 1988, doi:10.2307/2347496
double profileDeviation(const EffectFitProblem& problem, const EffectFit& fit,
                        const ParameterHandle& parameter, const ClaimRule& rule);

}  // namespace raven_correction
