// SPDX-License-Identifier: BSD-3-Clause
// Derivatives of the residual by the parameters of effects (effect_fit.h), by differences. What
// moves joints moves the tool by its Jacobian, so only what leaves the joints alone needs the
// kinematics of every sample again.
#include <algorithm>
#include <cmath>

#include "linear_residual.h"
#include "parallel.h"
#include "raven_correction/diagnosis/effect_fit.h"

namespace raven_correction {
namespace {

constexpr double kStepShare = 1e-3;     // of a parameter's range: width of a difference [-]
constexpr double kStepOfValue = 0.05;   // a difference is no wider than this share of the value [-]
constexpr double kSmallestStep = 0.05;  // and no narrower than this share of the first width [-]
constexpr double kDelayStep = 4e-3;     // held set-points make the residual a staircase [s]

/// Width and direction of the difference for one parameter.
double differenceStep(const EffectParameter& parameter, double value) {
  double step = kStepShare * (parameter.upper - parameter.lower);
  if (parameter.unit == "s" && parameter.joint < 0)
    step = kDelayStep;
  else if (value != 0.0)
    step = std::clamp(kStepOfValue * std::abs(value), kSmallestStep * step, step);
  return value + step > parameter.upper ? -step : step;
}

}  // namespace

Eigen::MatrixXd residualJacobian(const Recording& recording, const ResidualLayout& layout,
                                 const SimulationConfig& simulation,
                                 const std::vector<ParameterHandle>& parameters,
                                 const Eigen::VectorXd& values, const Eigen::VectorXd& residual,
                                 Eigen::Index first) {
  const auto p = static_cast<Eigen::Index>(parameters.size());
  Eigen::MatrixXd jacobian = Eigen::MatrixXd::Zero(layout.size, p);
  const SimulationConfig here = withValues(simulation, parameters, values);
  std::vector<bool> geometric;
  for (const ParameterHandle& parameter : parameters)
    geometric.push_back(leavesJointsAlone(here, parameter.effect));
  const auto of_tool = std::count(geometric.begin() + first, geometric.end(), true);
  const bool linear = !needsLoad(here) && p - first - of_tool > recording.robot.size();
  SimulatedSamples samples;
  if (of_tool > 1 || linear) residuals(recording, layout, here, &samples);
  std::unique_ptr<LinearResidual> by_joints;
  if (linear)
    by_joints = std::make_unique<LinearResidual>(recording, layout, here, samples, residual);
  parallelFor(static_cast<int>(p - first), [&](int index) {
    const Eigen::Index i = first + index;
    const EffectParameter parameter =
        parameterOf(simulation, parameters[static_cast<std::size_t>(i)]);
    const double step = differenceStep(parameter, values(i));
    // All other effects stay the very same.
    const SimulationConfig there = withValues(here, {parameters[static_cast<std::size_t>(i)]},
                                              Eigen::VectorXd::Constant(1, values(i) + step));
    const bool moves_tool = geometric[static_cast<std::size_t>(i)];
    if (moves_tool && samples.joints.size() > 0)
      jacobian.col(i) = (residualsOfJoints(recording, there, samples, residual) - residual) / step;
    else if (!moves_tool && by_joints)
      jacobian.col(i) = by_joints->changeTo(there) / step;
    else
      jacobian.col(i) = (residuals(recording, layout, there) - residual) / step;
  });
  return jacobian;
}

}  // namespace raven_correction
