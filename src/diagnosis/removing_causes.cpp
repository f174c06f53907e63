// SPDX-License-Identifier: BSD-3-Clause
// How a selection (selector.h) drops its causes in turn, and removes those that no longer earn
// their place beside the others.
#include <algorithm>
#include <cmath>

#include "parallel.h"
#include "raven_correction/diagnosis/noise_floor.h"
#include "raven_correction/error.h"
#include "selector.h"

namespace raven_correction {
namespace {

constexpr int kDropIterations = 4;  // of a pass
constexpr double kDropTolerance = 1e-5;
constexpr int kMostPasses = 6;
constexpr double kDropped = 5e-4;  // of the loss: a pass that gains no more is the last one [-]
constexpr double kSafe = 4.0;      // times the least share: it will not have to go [-]

}  // namespace

EffectFitProblem Selector::without(const Member& member) const {
  EffectFitProblem problem = problem_;
  const auto begin = static_cast<std::ptrdiff_t>(member.first);
  const auto end = static_cast<std::ptrdiff_t>(member.first + member.count);
  problem.simulation = withoutParameters(problem.simulation, member.hypothesis.parameters);
  problem.parameters.erase(problem.parameters.begin() + begin, problem.parameters.begin() + end);
  const Eigen::Index after = problem_.start.size() - member.first - member.count;
  problem.start.resize(member.first + after);
  problem.start << fit_.values.head(member.first), fit_.values.tail(after);
  problem.frozen.resize(layout_.size, member.first + after);
  problem.frozen << fit_.jacobian.leftCols(member.first), fit_.jacobian.rightCols(after);
  return problem;
}

EffectFit Selector::fitInPasses(EffectFitProblem& problem, Eigen::VectorXd residual) const {
  problem.max_iterations = kDropIterations;
  problem.tolerance = kDropTolerance;
  problem.with_covariance = false;
  EffectFit fit;
  double gained = 1.0;
  for (int pass = 0; pass < kMostPasses && gained > kDropped; ++pass) {
    // The scale shrinks as the others make up for it. Derivatives serve for all steps of a pass: a
    // pass that gains next to nothing has not left them.
    problem.scales = channelScales(layout_, residual);
    problem.frozen = residualJacobian(recording_, layout_, problem.simulation, problem.parameters,
                                      problem.start, residual);
    problem.start_residual = residual;
    fit = fitEffects(problem);
    gained = rule_.compare(residual, fit.residual).share;
    problem.start = fit.values;
    residual = fit.residual;
  }
  return fit;
}

Dropped Selector::drop(const Member& member, const LinearHeldOut& linear) const {
  EffectFitProblem problem = without(member);
  if (problem.parameters.empty())
    return {Eigen::VectorXd(), residuals(recording_, layout_, problem.simulation)};
  const auto at = [&](const Eigen::VectorXd& start) {
    return residuals(recording_, layout_,
                     withValues(problem.simulation, problem.parameters, start));
  };
  Eigen::VectorXd residual = at(problem.start);
  const Eigen::VectorXd led = linear.others(droppedOf(member));
  const Eigen::VectorXd led_residual = at(led);
  if (rule_.compare(residual, led_residual).share > 0.0) {
    problem.start = led;
    residual = led_residual;
  }
  const EffectFit fit = fitInPasses(problem, std::move(residual));
  return {fit.values, heldOutResiduals(problem, fit, options_.folds)};
}

LinearHeldOut::Dropped Selector::droppedOf(const Member& member) {
  const auto shapes =
      static_cast<Eigen::Index>(member.hypothesis.shapes - member.hypothesis.fixed_shapes);
  return {member.first, member.count - shapes, member.count};
}

bool Selector::isLinear(const Member& member) const {
  const ParameterHandle& first = member.hypothesis.parameters.front();
  return !isLimit(first.effect, parameterOf(problem_.simulation, first).symbol);
}

void Selector::dropEach(const std::vector<std::size_t>& members, Effort effort) {
  dropped_.resize(members_.size());
  kept_ = held_out_;
  const LinearHeldOut linear(problem_, fit_, options_.folds);
  if (effort == Effort::kLinear) kept_ = linear.residual();
  parallelFor(static_cast<int>(members.size()), [&](int index) {
    const std::size_t i = members[static_cast<std::size_t>(index)];
    const Member& member = members_[i];
    if (effort == Effort::kLinear && isLinear(member))
      dropped_[i] = {Eigen::VectorXd(), linear.residual(droppedOf(member))};
    else
      dropped_[i] = drop(member, linear);
  });
}

std::size_t Selector::weakestOf(const std::vector<std::size_t>& members) const {
  std::size_t weakest = members_.size();
  double least = 0.0;
  for (const std::size_t i : members) {
    const LossComparison comparison = rule_.compare(dropped_[i].held_out, kept_);
    if (members_[i].stays || rule_.earns(dropped_[i].held_out, kept_) ||
        (weakest < members_.size() && comparison.share >= least))
      continue;
    weakest = i;
    least = comparison.share;
  }
  return weakest;
}

std::vector<std::size_t> Selector::membersToDrop(bool all) const {
  std::vector<std::size_t> some;
  for (std::size_t i = 0; i < members_.size(); ++i)
    if (all || members_[i].share < kSafe * options_.least_share) some.push_back(i);
  return some;
}

void Selector::removeWeak(Effort effort) {
  // By derivatives all are dropped at once; else first those that did not explain much then.
  for (Member& member : members_) member.stays = false;
  for (bool all = effort == Effort::kLinear; !members_.empty();) {
    const std::vector<std::size_t> tried = membersToDrop(all);
    say(format("removing what no longer earns its place: %zu of %zu causes dropped in turn",
               tried.size(), members_.size()),
        effort == Effort::kLinear ? 0.88 : 0.93);
    dropEach(tried, effort);
    rule_.setClaims(members_.size());
    for (const std::size_t i : tried)
      members_[i].share = rule_.compare(dropped_[i].held_out, kept_).share;
    const std::size_t weakest = weakestOf(tried);
    if (weakest < members_.size()) {
      if (effort == Effort::kLinear && !isConfirmed(weakest)) continue;
      remove(weakest);
      releaseAtBounds();
      trimGroups();
      all = false;
    } else if (all) {
      return;
    } else {
      all = true;
    }
  }
}

bool Selector::isConfirmed(std::size_t weakest) {
  Member& member = members_[weakest];
  dropped_[weakest] = drop(member, LinearHeldOut(problem_, fit_, options_.folds));
  member.share = rule_.compare(dropped_[weakest].held_out, held_out_).share;
  member.stays = rule_.earns(dropped_[weakest].held_out, held_out_);
  return !member.stays;
}

void Selector::remove(std::size_t weakest) {
  const Member gone = members_[weakest];
  problem_ = without(gone);
  // Where they have been fitted without it, the others are there already.
  if (weakest < dropped_.size() && dropped_[weakest].others.size() == problem_.start.size())
    problem_.start = dropped_[weakest].others;
  members_.erase(members_.begin() + static_cast<std::ptrdiff_t>(weakest));
  dropped_.clear();
  for (Member& member : members_)
    if (member.first > gone.first) member.first -= gone.count;
  if (members_.empty()) {
    fit_ = EffectFit();
    fit_.residual = held_out_ =
        residuals(recording_, layout_, problem_.simulation, &result_.held_out);
    rule_.setNoise(noiseFloor(recording_, problem_.simulation));
    fit_.jacobian.resize(layout_.size, 0);
  } else {
    refit();
  }
}

}  // namespace raven_correction
