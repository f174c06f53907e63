// SPDX-License-Identifier: BSD-3-Clause
// How a selection (selector.h) finds the next cause: what explains most is fitted, and the simplest
// of those that explain as much is added if it earns its place.
#include <algorithm>
#include <numeric>

#include "parallel.h"
#include "raven_correction/error.h"
#include "selector.h"

namespace raven_correction {
namespace {

constexpr int kFinalistIterations = 5;
constexpr double kFinalistTolerance = 1e-4;
constexpr int kRoundsOfAll = 4;         // every so many rounds all hypotheses are screened
constexpr std::size_t kPromising = 40;  // and so many of them in the rounds between
constexpr double kTie = 2.0;            // z below which two explanations cannot be told apart
constexpr double kTieShare = 0.9;  // and the lesser one explains at least this part of the better
constexpr std::size_t kMostEquals = 3;

}  // namespace

EffectFitProblem Selector::with(const Candidate& candidate) const {
  EffectFitProblem problem = problem_;
  const Hypothesis& hypothesis = candidate.hypothesis;
  const auto free =
      static_cast<Eigen::Index>(hypothesis.parameters.size() - hypothesis.fixed_shapes);
  const auto p = static_cast<Eigen::Index>(problem.parameters.size());
  problem.parameters.insert(problem.parameters.end(), hypothesis.parameters.begin(),
                            hypothesis.parameters.begin() + free);
  const std::vector<ParameterHandle> fixed(hypothesis.parameters.begin() + free,
                                           hypothesis.parameters.end());
  problem.simulation =
      withValues(problem.simulation, fixed,
                 candidate.start.tail(static_cast<Eigen::Index>(hypothesis.fixed_shapes)));
  problem.start.resize(p + free);
  problem.start << candidate.others, candidate.start.head(free);
  return problem;
}

std::vector<Finalist> Selector::fitFinalists(std::vector<Candidate> candidates) const {
  candidates.resize(std::min(candidates.size(), static_cast<std::size_t>(options_.finalists)));
  const Eigen::VectorXd scales = channelScales(layout_, fit_.residual);
  std::vector<Finalist> finalists(candidates.size());
  parallelFor(static_cast<int>(candidates.size()), [&](int index) {
    const auto i = static_cast<std::size_t>(index);
    EffectFitProblem problem = with(candidates[i]);
    problem.scales = scales;
    problem.max_iterations = kFinalistIterations;
    problem.tolerance = kFinalistTolerance;
    problem.frozen = fit_.jacobian;
    problem.with_covariance = false;
    finalists[i].candidate = candidates[i];
    finalists[i].fit = fitEffects(problem);
    finalists[i].held_out = heldOutResiduals(problem, finalists[i].fit, options_.folds);
  });
  const auto ends_at_bound = [&](const Finalist& finalist) {
    const Hypothesis& hypothesis = finalist.candidate.hypothesis;
    for (std::size_t k = 0; k < hypothesis.amplitudes(); ++k)
      if (isAtBound(hypothesis.parameters[k],
                    finalist.fit.values(fit_.values.size() + static_cast<Eigen::Index>(k))))
        return true;
    return false;
  };
  finalists.erase(std::remove_if(finalists.begin(), finalists.end(), ends_at_bound),
                  finalists.end());
  return finalists;
}

const Finalist* Selector::choose(const std::vector<Finalist>& finalists, Member& member) const {
  std::vector<double> gain;
  for (const Finalist& finalist : finalists)
    gain.push_back(rule_.compare(held_out_, finalist.held_out).share);
  std::vector<std::size_t> order(finalists.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(),
            [&](std::size_t a, std::size_t b) { return gain[a] > gain[b]; });
  const auto found = std::find_if(order.begin(), order.end(), [&](std::size_t i) {
    return rule_.earns(held_out_, finalists[i].held_out);
  });
  if (found == order.end()) return nullptr;
  const std::size_t best = *found;
  std::vector<std::size_t> equal;
  std::size_t rest = finalists.size();
  for (std::size_t i = 0; i < finalists.size(); ++i) {
    // At the scale of what the best one leaves, small differences show.
    const Eigen::VectorXd& better = finalists[best].held_out;
    const LossComparison worse = rule_.compare(finalists[i].held_out, better, better);
    if (i == best || (worse.z_mean <= kTie && gain[i] >= kTieShare * gain[best]))
      equal.push_back(i);
    else if (rest == finalists.size() || gain[i] > gain[rest])
      rest = i;
  }
  const auto simpler = [&](std::size_t a, std::size_t b) {
    const std::size_t pa = finalists[a].candidate.hypothesis.parameters.size();
    const std::size_t pb = finalists[b].candidate.hypothesis.parameters.size();
    return pa != pb ? pa < pb : gain[a] > gain[b];
  };
  std::sort(equal.begin(), equal.end(), simpler);
  const std::size_t simplest = *std::find_if(equal.begin(), equal.end(), [&](std::size_t i) {
    return i == best || rule_.earns(held_out_, finalists[i].held_out);
  });
  const Finalist& chosen = finalists[simplest];
  member.hypothesis = chosen.candidate.hypothesis;
  for (const std::size_t i : equal)
    if (i != simplest && member.equals.size() < kMostEquals)
      member.equals.push_back(finalists[i].candidate.hypothesis);
  if (rest < finalists.size() && gain[rest] > 0.0) {
    member.has_runner_up = true;
    member.runner_up = finalists[rest].candidate.hypothesis;
    member.runner_up_share = gain[rest] / std::max(gain[simplest], 1e-12);
  }
  return &chosen;
}

std::vector<Hypothesis> Selector::openHypotheses(bool all) const {
  std::vector<Hypothesis> open;
  for (const Hypothesis& hypothesis : all ? hypotheses_ : promising_) {
    const bool in = std::any_of(members_.begin(), members_.end(), [&](const Member& member) {
      return overlaps(member.hypothesis, hypothesis);
    });
    const bool released =
        std::any_of(released_.begin(), released_.end(),
                    [&](const Hypothesis& other) { return overlaps(other, hypothesis); });
    if (!in && !released) open.push_back(hypothesis);
  }
  return open;
}

std::vector<Hypothesis> Selector::openGroups() const {
  std::vector<Hypothesis> groups = togetherHypotheses(openHypotheses(true), recording_.robot);
  const auto room = static_cast<std::size_t>(options_.max_causes) - members_.size();
  const auto too_many = [&](const Hypothesis& group) {
    return partsOf(group, recording_.robot).size() > room;
  };
  groups.erase(std::remove_if(groups.begin(), groups.end(), too_many), groups.end());
  return groups;
}

std::vector<Finalist> Selector::tryHypotheses(int round, bool all) {
  return tryHypotheses(round, all, openHypotheses(all));
}

std::vector<Finalist> Selector::tryHypotheses(int round, bool all,
                                              const std::vector<Hypothesis>& open) {
  say(format("round %d: trying %zu hypotheses", round + 1, open.size()),
      std::min(0.85, 0.1 + 0.08 * round));
  const Screening screening = screen(problem_, fit_, open, summary_);
  if (members_.empty() && all) {
    result_.starts = screening.starts + togetherHypotheses(hypotheses_, recording_.robot).size();
    rule_.setTried(result_.starts, options_.significance);
  }
  if (all) {
    promising_.clear();
    for (const Candidate& candidate : screening.candidates)
      if (promising_.size() < kPromising) promising_.push_back(candidate.hypothesis);
  }
  return fitFinalists(screening.candidates);
}

bool Selector::add(int round) {
  Member member;
  rule_.setClaims(members_.size() + 1);
  bool all = round % kRoundsOfAll == 0;
  std::vector<Finalist> finalists = tryHypotheses(round, all);
  const Finalist* choice = choose(finalists, member);
  if (!choice && !all) {
    finalists = tryHypotheses(round, true);
    choice = choose(finalists, member);
  }
  if (!choice && !members_.empty()) {  // what is too weak alone may not be together
    finalists = tryHypotheses(round, false, openGroups());
    choice = choose(finalists, member);
    member.together = true;
  }
  if (!choice) return false;
  const Finalist& chosen = *choice;
  member.first = static_cast<Eigen::Index>(problem_.parameters.size());
  Candidate from = chosen.candidate;
  from.others = chosen.fit.values.head(member.first);
  const auto free = chosen.fit.values.size() - member.first;
  from.start.head(free) = chosen.fit.values.tail(free);
  problem_ = with(from);
  member.count = free;
  addMembers(std::move(member));
  refit();
  releaseAtBounds();
  return true;
}

void Selector::addMembers(Member member) {
  if (!member.together) {
    members_.push_back(std::move(member));
    return;
  }
  Eigen::Index first = member.first;
  const Hypothesis whole = member.hypothesis;
  std::vector<std::vector<ParameterHandle>> parts = partsOf(whole, recording_.robot);
  if (parts.size() > 1) {
    member.equals.clear();
    member.has_runner_up = false;
  }
  for (std::vector<ParameterHandle>& part : parts) {
    member.first = first;
    member.count = static_cast<Eigen::Index>(part.size());
    member.hypothesis = hypothesisOf(std::move(part), recording_.robot);
    first += member.count;
    members_.push_back(member);
  }
}

}  // namespace raven_correction
