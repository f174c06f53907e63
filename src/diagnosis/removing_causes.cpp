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

constexpr double kLastTolerance = 1e-6;
constexpr int kDropIterations = 3;
constexpr double kSameScales = 0.02;  // change of a channel's scale that needs no second fit [-]
constexpr double kSafe = 4.0;         // times the least share: it will not have to go [-]
constexpr double kDoubtful = 2.0;  // deviations from nothing of a parameter that leaves its group

}  // namespace

EffectFitProblem Selector::without(const Member& member) const {
  EffectFitProblem problem = problem_;
  const auto begin = static_cast<std::ptrdiff_t>(member.first);
  const auto end = static_cast<std::ptrdiff_t>(member.first + member.count);
  problem.simulation = withValues(
      problem.simulation, member.hypothesis.parameters,
      Eigen::VectorXd::Zero(static_cast<Eigen::Index>(member.hypothesis.parameters.size())));
  problem.parameters.erase(problem.parameters.begin() + begin, problem.parameters.begin() + end);
  const Eigen::Index after = problem_.start.size() - member.first - member.count;
  problem.start.resize(member.first + after);
  problem.start << fit_.values.head(member.first), fit_.values.tail(after);
  problem.frozen.resize(layout_.size, member.first + after);
  problem.frozen << fit_.jacobian.leftCols(member.first), fit_.jacobian.rightCols(after);
  return problem;
}

Eigen::VectorXd Selector::drop(const Member& member, const LinearHeldOut& linear) const {
  EffectFitProblem problem = without(member);
  if (problem.parameters.empty()) return residuals(recording_, layout_, problem.simulation);
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
  problem.max_iterations = kDropIterations;
  problem.tolerance = kLastTolerance;
  problem.frozen.resize(0, 0);
  problem.with_covariance = false;
  EffectFit fit;
  for (int pass = 0; pass < 2; ++pass) {  // the scale shrinks as the others make up for it
    const Eigen::VectorXd scales = channelScales(layout_, residual);
    if (pass > 0 && scales.isApprox(problem.scales, kSameScales)) break;
    problem.scales = scales;
    fit = fitEffects(problem);
    problem.start = fit.values;
    residual = fit.residual;
  }
  return heldOutResiduals(problem, fit, options_.folds);
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
    dropped_[i] = effort == Effort::kLinear && isLinear(member) ? linear.residual(droppedOf(member))
                                                                : drop(member, linear);
  });
}

std::size_t Selector::weakestOf(const std::vector<std::size_t>& members) const {
  std::size_t weakest = members_.size();
  double least = 0.0;
  for (const std::size_t i : members) {
    const LossComparison comparison = rule_.compare(dropped_[i], kept_);
    if (rule_.earns(dropped_[i], kept_) || (weakest < members_.size() && comparison.share >= least))
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
  for (bool all = effort == Effort::kLinear; !members_.empty();) {
    const std::vector<std::size_t> tried = membersToDrop(all);
    say(format("removing what no longer earns its place: %zu of %zu causes dropped in turn",
               tried.size(), members_.size()),
        effort == Effort::kLinear ? 0.88 : 0.93);
    dropEach(tried, effort);
    rule_.setClaims(members_.size());
    for (const std::size_t i : tried) members_[i].share = rule_.compare(dropped_[i], kept_).share;
    const std::size_t weakest = weakestOf(tried);
    if (weakest < members_.size()) {
      remove(weakest);
      all = false;
    } else if (all) {
      return;
    } else {
      all = true;
    }
  }
}

void Selector::remove(std::size_t weakest) {
  const Member gone = members_[weakest];
  problem_ = without(gone);
  members_.erase(members_.begin() + static_cast<std::ptrdiff_t>(weakest));
  dropped_.erase(dropped_.begin() + static_cast<std::ptrdiff_t>(weakest));
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

void Selector::trimGroups() {
  std::vector<ParameterHandle> parameters, gone;
  std::vector<double> start;
  for (Member& member : members_) {
    std::vector<ParameterHandle> kept, doubtful;
    std::vector<double> values;
    for (Eigen::Index i = member.first; i < member.first + member.count; ++i) {
      const bool doubt = std::abs(fit_.values(i)) < kDoubtful * std::sqrt(fit_.covariance(i, i));
      const bool leaves = member.together && doubt;
      (leaves ? doubtful : kept).push_back(problem_.parameters[static_cast<std::size_t>(i)]);
      if (!leaves) values.push_back(fit_.values(i));
    }
    if (kept.empty()) {  // whether it goes as a whole is for removeWeak() to say
      kept.swap(doubtful);
      const auto all = fit_.values.segment(member.first, member.count);
      values.assign(all.begin(), all.end());
    }
    if (member.together) member.hypothesis = hypothesisOf(kept, recording_.robot);
    member.first = static_cast<Eigen::Index>(parameters.size());
    member.count = static_cast<Eigen::Index>(kept.size());
    parameters.insert(parameters.end(), kept.begin(), kept.end());
    start.insert(start.end(), values.begin(), values.end());
    gone.insert(gone.end(), doubtful.begin(), doubtful.end());
  }
  problem_.simulation = withValues(problem_.simulation, gone,
                                   Eigen::VectorXd::Zero(static_cast<Eigen::Index>(gone.size())));
  problem_.parameters = std::move(parameters);
  problem_.start =
      Eigen::Map<Eigen::VectorXd>(start.data(), static_cast<Eigen::Index>(start.size()));
}

}  // namespace raven_correction
