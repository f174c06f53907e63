// SPDX-License-Identifier: BSD-3-Clause
#include "raven_correction/diagnosis/held_out.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "parallel.h"
#include "raven_correction/geometry/statistics.h"

namespace raven_correction {
namespace {

constexpr int kResamples = 1000;

/// Parameters of one fold: a step from those of all motions.
Eigen::VectorXd withoutFold(const EffectFitProblem& problem, const EffectFit& fit,
                            const Eigen::MatrixXd& H, const Eigen::VectorXd& g) {
  Eigen::MatrixXd damped = H;
  const Eigen::Index p = fit.values.size();
  std::vector<EffectParameter> parameters;
  for (Eigen::Index i = 0; i < p; ++i) {
    parameters.push_back(
        parameterOf(problem.simulation, problem.parameters[static_cast<std::size_t>(i)]));
    // What the other motions do not determine stays where it is.
    damped(i, i) +=
        1e-9 * H(i, i) + std::pow(parameters.back().upper - parameters.back().lower, -2);
  }
  Eigen::VectorXd values = fit.values - damped.ldlt().solve(g);
  for (Eigen::Index i = 0; i < p; ++i) {
    const EffectParameter& parameter = parameters[static_cast<std::size_t>(i)];
    values(i) = std::isfinite(values(i)) ? std::clamp(values(i), parameter.lower, parameter.upper)
                                         : fit.values(i);
  }
  return values;
}

}  // namespace

Eigen::VectorXd heldOutResiduals(const EffectFitProblem& problem, const EffectFit& fit, int folds,
                                 SimulatedSamples* simulated) {
  const ResidualLayout& layout = *problem.layout;
  if (problem.parameters.empty())
    return simulated ? residuals(*problem.recording, layout, problem.simulation, simulated)
                     : fit.residual;
  const Eigen::VectorXd scales = channelScales(layout, fit.residual, problem.use);
  const std::vector<NormalEquations> motions =
      normalEquations(layout, fit.residual, fit.jacobian, scales);
  const Eigen::Index p = fit.values.size();
  NormalEquations all{Eigen::MatrixXd::Zero(p, p), Eigen::VectorXd::Zero(p)};
  for (const NormalEquations& motion : motions) {
    all.H += motion.H;
    all.g += motion.g;
  }
  Eigen::VectorXd result = fit.residual;
  if (simulated) {
    const auto blocks = static_cast<Eigen::Index>(layout.blocks.size());
    simulated->joints.resize(problem.recording->robot.size(), blocks);
    simulated->orientation.resize(4, blocks);
  }
  parallelFor(folds, [&](int fold) {
    NormalEquations rest = all;
    for (std::size_t m = static_cast<std::size_t>(fold); m < motions.size();
         m += static_cast<std::size_t>(folds)) {
      rest.H -= motions[m].H;
      rest.g -= motions[m].g;
    }
    SimulatedSamples samples;
    const Eigen::VectorXd there = residuals(*problem.recording, layout,
                                            withValues(problem.simulation, problem.parameters,
                                                       withoutFold(problem, fit, rest.H, rest.g)),
                                            simulated ? &samples : nullptr);
    for (std::size_t b = 0; b < layout.blocks.size(); ++b) {
      const ResidualBlock& block = layout.blocks[b];
      if (block.motion % folds != fold) continue;
      if (simulated) {
        const auto column = static_cast<Eigen::Index>(b);
        simulated->joints.col(column) = samples.joints.col(column);
        simulated->orientation.col(column) = samples.orientation.col(column);
      }
      const int size = layout.sizeOf(block);
      result.segment(block.offset, size) = there.segment(block.offset, size);
    }
  });
  return result;
}

LossComparison compareLosses(const Eigen::VectorXd& before, const Eigen::VectorXd& after,
                             std::uint64_t seed) {
  std::vector<double> base, difference;
  for (Eigen::Index m = 0; m < before.size(); ++m) {
    if (!std::isfinite(before(m)) || !std::isfinite(after(m))) continue;
    base.push_back(before(m));
    difference.push_back(before(m) - after(m));
  }
  LossComparison result;
  const std::size_t n = base.size();
  if (n < 2 || !(mean(base) > 0.0)) return result;
  const double gain = mean(difference);
  result.share = gain / mean(base);
  const double root = std::sqrt(static_cast<double>(n));
  const double tiny = 1e-12 * mean(base);
  result.z_mean = gain / (standardDeviation(difference) / root + tiny);
  std::vector<double> away;
  const double middle = median(difference);
  for (const double d : difference) away.push_back(std::abs(d - middle));
  result.z_typical = gain / (1.4826 * median(away) / root + tiny);

  std::vector<double> shares;
  bootstrapOverGroups(n, kResamples, seed, [&](const std::vector<std::size_t>& drawn) {
    double total = 0.0, gained = 0.0;
    for (const std::size_t at : drawn) {
      total += base[at];
      gained += difference[at];
    }
    shares.push_back(gained / total);
  });
  const Interval interval = interval95(shares);
  result.lower = interval.lower;
  result.upper = interval.upper;
  return result;
}

}  // namespace raven_correction
