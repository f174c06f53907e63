// SPDX-License-Identifier: BSD-3-Clause
#include "profile_deviation.h"

#include <Eigen/Cholesky>
#include <algorithm>

namespace raven_correction {
namespace {

constexpr double kFall = 0.5;               // of the log likelihood at one standard deviation
constexpr double kFirstStep = 1e-7;         // of the range [-]
constexpr double kResolution = 1.0 / 32.0;  // of the width that is found [-]

}  // namespace

double profileDeviation(const EffectFitProblem& problem, const EffectFit& fit,
                        const ParameterHandle& parameter, const ClaimRule& rule) {
  const ResidualLayout& layout = *problem.layout;
  const EffectParameter here = parameterOf(problem.simulation, parameter);
  const SimulationConfig fitted = withValues(problem.simulation, problem.parameters, fit.values);
  const Eigen::VectorXd scales = channelScales(layout, fit.residual);
  const double most = rule.logLikelihood(fit.residual, fit.residual);
  const auto falls = [&](double value) {
    Eigen::VectorXd residual =
        residuals(*problem.recording, layout,
                  withValues(fitted, {parameter}, Eigen::VectorXd::Constant(1, value)));
    const Eigen::VectorXd weights = rowWeights(layout, residual, scales);
    const Eigen::MatrixXd WJ = weights.asDiagonal() * fit.jacobian;
    Eigen::MatrixXd H = WJ.transpose() * fit.jacobian;
    H.diagonal() *= 1.0 + 1e-9;
    H.diagonal().array() += 1e-300;
    residual -= fit.jacobian * H.ldlt().solve(WJ.transpose() * residual);
    return most - rule.logLikelihood(residual, fit.residual) > kFall;
  };
  // From the value outwards in steps that double, then between the last two.
  const auto width = [&](double end) {
    const double sign = end < here.value ? -1.0 : 1.0, farthest = std::abs(end - here.value);
    double inside = 0.0, outside = kFirstStep * (here.upper - here.lower);
    while (outside < farthest && !falls(here.value + sign * outside)) {
      inside = outside;
      outside *= 2.0;
    }
    if (outside >= farthest) return farthest;
    while (outside - inside > kResolution * outside) {
      const double middle = 0.5 * (inside + outside);
      (falls(here.value + sign * middle) ? outside : inside) = middle;
    }
    return outside;
  };
  return 0.5 * (width(here.lower) + width(here.upper));
}

}  // namespace raven_correction
