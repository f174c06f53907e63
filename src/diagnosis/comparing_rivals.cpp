// SPDX-License-Identifier: BSD-3-Clause
// What a selection (selector.h) cannot tell from its causes: each rival takes the place of its
// cause beside all the others, and the two are compared by what they predict.
#include <algorithm>

#include "parallel.h"
#include "profile_deviation.h"
#include "selector.h"

namespace raven_correction {

bool Selector::isMember(const Hypothesis& hypothesis) const {
  return std::any_of(members_.begin(), members_.end(),
                     [&](const Member& member) { return overlaps(member.hypothesis, hypothesis); });
}

std::unique_ptr<Rival> Selector::compareWith(const Candidate& equal, const Member& member,
                                             const Dropped& dropped) const {
  Candidate candidate = equal;
  EffectFitProblem problem = without(member);
  candidate.others = dropped.others.size() == problem.start.size() ? dropped.others : problem.start;
  const Eigen::Index first = problem.start.size();
  problem = with(std::move(problem), candidate);
  EffectFit fit = fitInPasses(
      problem, residuals(recording_, layout_,
                         withValues(problem.simulation, problem.parameters, problem.start)));
  if (endsAtBound(candidate.hypothesis, fit, first)) return nullptr;
  const Eigen::VectorXd held_out = heldOutResiduals(problem, fit, options_.folds);

  const LossComparison ahead = rule_.compare(held_out, held_out_, held_out_);
  const double gain = rule_.compare(dropped.held_out, held_out_).share;
  const double rivals_gain = rule_.compare(dropped.held_out, held_out).share;
  // Differences that are next to nothing, but of one sign, have a large z: where the motions hold
  // less than that many deviations of information, they tell nobody apart.
  const double information = -rule_.logLikelihood(held_out - held_out_, held_out_);
  const bool told_apart =
      ahead.z_mean > Rival::kTie && information > 0.5 * Rival::kTie * Rival::kTie;
  if (told_apart || rivals_gain < kTieShare * gain) return nullptr;

  auto rival = std::make_unique<Rival>();
  rival->hypothesis = candidate.hypothesis;
  rival->values = candidate.start;
  rival->deviations = Eigen::VectorXd::Zero(candidate.start.size());
  const Eigen::Index free = fit.values.size() - first;
  rival->values.head(free) = fit.values.tail(free);
  rival->deviations.head(free) = effectCovariance(problem, fit).diagonal().tail(free).cwiseSqrt();
  for (Eigen::Index i = free; i < rival->values.size(); ++i)
    rival->deviations(i) = profileDeviation(
        problem, fit, rival->hypothesis.parameters[static_cast<std::size_t>(i)], rule_);
  rival->relative_gain = rivals_gain / std::max(gain, 1e-12);
  rival->z = ahead.z_mean;
  rival->log_likelihood =
      rule_.logLikelihood(held_out_, held_out_) - rule_.logLikelihood(held_out, held_out_);
  rival->log_likelihood_expected = information;
  return rival;
}

std::vector<std::vector<Rival>> Selector::rivals() const {
  struct Pair {
    std::size_t member;
    const Candidate* equal;
  };
  std::vector<Pair> pairs;
  for (std::size_t m = 0; m < members_.size(); ++m)
    for (const Candidate& equal : members_[m].equals)
      if (!isMember(equal.hypothesis)) pairs.push_back({m, &equal});
  std::vector<std::unique_ptr<Rival>> compared(pairs.size());
  parallelFor(static_cast<int>(pairs.size()), [&](int index) {
    const auto i = static_cast<std::size_t>(index);
    const std::size_t m = pairs[i].member;
    compared[i] = compareWith(*pairs[i].equal, members_[m], dropped_[m]);
  });
  std::vector<std::vector<Rival>> all(members_.size());
  for (std::size_t i = 0; i < pairs.size(); ++i)
    if (compared[i]) all[pairs[i].member].push_back(std::move(*compared[i]));
  return all;
}

}  // namespace raven_correction
