// SPDX-License-Identifier: BSD-3-Clause
#include "raven_correction/diagnosis/held_out.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "parallel.h"
#include "raven_correction/geometry/statistics.h"

namespace raven_correction {
namespace {

/// Normal equations of all motions but those of a fold, for each fold.
std::vector<NormalEquations> equationsWithoutFolds(const EffectFitProblem& problem,
                                                   const EffectFit& fit, int folds) {
  const ResidualLayout& layout = *problem.layout;
  const Eigen::VectorXd scales = channelScales(layout, fit.residual, problem.use);
  const std::vector<NormalEquations> motions =
      normalEquations(layout, fit.residual, fit.jacobian, scales);
  const Eigen::Index p = fit.values.size();
  NormalEquations all{Eigen::MatrixXd::Zero(p, p), Eigen::VectorXd::Zero(p)};
  for (const NormalEquations& motion : motions) {
    all.H += motion.H;
    all.g += motion.g;
  }
  std::vector<NormalEquations> rests(static_cast<std::size_t>(folds), all);
  for (std::size_t m = 0; m < motions.size(); ++m) {
    NormalEquations& rest = rests[m % static_cast<std::size_t>(folds)];
    rest.H -= motions[m].H;
    rest.g -= motions[m].g;
  }
  return rests;
}

/// H with what keeps a parameter where it is that the other motions do not determine.
Eigen::MatrixXd damped(const EffectFitProblem& problem, Eigen::MatrixXd H) {
  for (Eigen::Index i = 0; i < H.rows(); ++i) {
    const EffectParameter parameter =
        parameterOf(problem.simulation, problem.parameters[static_cast<std::size_t>(i)]);
    H(i, i) += 1e-9 * H(i, i) + std::pow(parameter.upper - parameter.lower, -2);
  }
  return H;
}

/// Within the ranges of the parameters; where there is no number, as in the fit.
Eigen::VectorXd clipped(const EffectFitProblem& problem, const EffectFit& fit,
                        Eigen::VectorXd values) {
  for (Eigen::Index i = 0; i < values.size(); ++i) {
    const EffectParameter parameter =
        parameterOf(problem.simulation, problem.parameters[static_cast<std::size_t>(i)]);
    values(i) = std::isfinite(values(i)) ? std::clamp(values(i), parameter.lower, parameter.upper)
                                         : fit.values(i);
  }
  return values;
}

/// Parameters of one fold: a step from those of all motions.
Eigen::VectorXd withoutFold(const EffectFitProblem& problem, const EffectFit& fit,
                            const NormalEquations& rest) {
  return clipped(problem, fit, fit.values - damped(problem, rest.H).ldlt().solve(rest.g));
}

}  // namespace

Eigen::VectorXd heldOutResiduals(const EffectFitProblem& problem, const EffectFit& fit, int folds,
                                 SimulatedSamples* simulated) {
  const ResidualLayout& layout = *problem.layout;
  if (problem.parameters.empty())
    return simulated ? residuals(*problem.recording, layout, problem.simulation, simulated)
                     : fit.residual;
  const std::vector<NormalEquations> rests = equationsWithoutFolds(problem, fit, folds);
  Eigen::VectorXd result = fit.residual;
  if (simulated) {
    const auto blocks = static_cast<Eigen::Index>(layout.blocks.size());
    simulated->joints.resize(problem.recording->robot.size(), blocks);
    simulated->since_start.resize(blocks);
    simulated->orientation.resize(4, blocks);
  }
  parallelFor(folds, [&](int fold) {
    const NormalEquations& rest = rests[static_cast<std::size_t>(fold)];
    std::vector<bool> use;
    for (int m = 0; m < layout.motions; ++m) use.push_back(m % folds == fold);
    SimulatedSamples samples;
    const Eigen::VectorXd there = residuals(
        *problem.recording, layout,
        withValues(problem.simulation, problem.parameters, withoutFold(problem, fit, rest)),
        simulated ? &samples : nullptr, use);
    for (std::size_t b = 0; b < layout.blocks.size(); ++b) {
      const ResidualBlock& block = layout.blocks[b];
      if (block.motion % folds != fold) continue;
      if (simulated) {
        const auto column = static_cast<Eigen::Index>(b);
        simulated->joints.col(column) = samples.joints.col(column);
        simulated->since_start(column) = samples.since_start(column);
        simulated->orientation.col(column) = samples.orientation.col(column);
      }
      const int size = layout.sizeOf(block);
      result.segment(block.offset, size) = there.segment(block.offset, size);
    }
  });
  return result;
}

LinearHeldOut::LinearHeldOut(const EffectFitProblem& problem, const EffectFit& fit, int folds)
    : problem_(problem), fit_(fit), without_(equationsWithoutFolds(problem, fit, folds)) {}

Eigen::VectorXd LinearHeldOut::step(const NormalEquations& equations,
                                    const Dropped& dropped) const {
  const Eigen::Index p = fit_.values.size();
  std::vector<Eigen::Index> free;
  for (Eigen::Index i = 0; i < p; ++i)
    if (i < dropped.first || i >= dropped.first + dropped.count) free.push_back(i);
  Eigen::VectorXd step = Eigen::VectorXd::Zero(p);
  step.segment(dropped.first, dropped.amplitudes) =
      -fit_.values.segment(dropped.first, dropped.amplitudes);
  const Eigen::VectorXd g = equations.g + equations.H * step;
  const Eigen::MatrixXd H = damped(problem_, equations.H);
  step(free) -= Eigen::MatrixXd(H(free, free)).ldlt().solve(Eigen::VectorXd(g(free)));
  const Eigen::VectorXd values = clipped(problem_, fit_, fit_.values + step);
  for (const Eigen::Index i : free) step(i) = values(i) - fit_.values(i);
  return step;
}

Eigen::VectorXd LinearHeldOut::others(const Dropped& dropped) const {
  NormalEquations all = without_.front();
  for (std::size_t fold = 1; fold < without_.size(); ++fold) {
    all.H += without_[fold].H;
    all.g += without_[fold].g;
  }
  const double times = static_cast<double>(without_.size()) - 1.0;  // every motion is in it
  all.H /= times;
  all.g /= times;
  const Eigen::VectorXd values = fit_.values + step(all, dropped);
  const Eigen::Index after = values.size() - dropped.first - dropped.count;
  Eigen::VectorXd others(dropped.first + after);
  others << values.head(dropped.first), values.tail(after);
  return others;
}

Eigen::VectorXd LinearHeldOut::residual(const Dropped& dropped) const {
  Eigen::MatrixXd steps(fit_.values.size(), static_cast<Eigen::Index>(without_.size()));
  for (std::size_t fold = 0; fold < without_.size(); ++fold)
    steps.col(static_cast<Eigen::Index>(fold)) = step(without_[fold], dropped);
  Eigen::VectorXd result = fit_.residual;
  const auto folds = static_cast<int>(without_.size());
  const std::vector<ResidualBlock>& blocks = problem_.layout->blocks;
  for (std::size_t b = 0; b < blocks.size();) {  // the rows of a motion are neighbours
    const int motion = blocks[b].motion;
    const Eigen::Index begin = blocks[b].offset;
    while (b < blocks.size() && blocks[b].motion == motion) ++b;
    const Eigen::Index rows =
        (b < blocks.size() ? blocks[b].offset : problem_.layout->size) - begin;
    result.segment(begin, rows).noalias() +=
        fit_.jacobian.middleRows(begin, rows) * steps.col(motion % folds);
  }
  return result;
}

LossComparison compareLosses(const Eigen::VectorXd& before, const Eigen::VectorXd& after,
                             std::uint64_t seed, int resamples) {
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

  if (resamples == 0) return result;
  std::vector<double> shares;
  bootstrapOverGroups(n, resamples, seed, [&](const std::vector<std::size_t>& drawn) {
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
