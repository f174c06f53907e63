// SPDX-License-Identifier: BSD-3-Clause
// A first look at all hypotheses: how much of the residual each would explain if its effect were
// linear, with everything that is fitted already free to give way. Cheap: one simulation for each
// amplitude and start. The promising ones are fitted in selection.h.
#pragma once

#include <vector>

#include "raven_correction/diagnosis/residual_starts.h"

namespace raven_correction {

/// A hypothesis with the point where its fit begins.
struct Candidate {
  Hypothesis hypothesis;
  Eigen::VectorXd start;   ///< of its parameters, each in its own unit
  Eigen::VectorXd others;  ///< of the parameters in the fit so far, each in its own unit
  double share = 0.0;      ///< of the weighted squared residual that the linear model explains [-]
};

struct Screening {
  std::vector<Candidate> candidates;  ///< one per hypothesis at its best start, best first
  std::size_t starts = 0;             ///< looked at, periods and instants included
};

/// With r the weighted residual, J its weighted derivatives by the parameters fitted so far, and D
/// its weighted changes, one column per amplitude of the hypothesis (each from a simulation of its
/// own),
///
///   share = (min over a of |r + J a|^2  -  min over a, b of |r + J a + D b|^2) / |r|^2
///
/// b, as a multiple of the amplitude that was tried, says where a fit begins.
/// @param problem     the fit so far; may have no parameters
/// @param fit         its result
/// @param hypotheses  to look at; none may share a parameter with the fit
/// @param summary     of the problem's recording
/// @return candidates with a share above 0, best first; amplitudes within their ranges
/// @throws InvalidInput  a hypothesis names an effect or a parameter that there is not
Screening screen(const EffectFitProblem& problem, const EffectFit& fit,
                 const std::vector<Hypothesis>& hypotheses, const RecordingSummary& summary);

}  // namespace raven_correction
