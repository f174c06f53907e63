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
constexpr std::size_t kMostEquals = 3;
constexpr std::size_t kAtOnce = 2;  // finalists whose held-out motions are simulated together

/// A finalist as a candidate that begins where its fit ended, its own parameters from `first` on.
Candidate fitted(const Finalist& finalist, Eigen::Index first) {
  Candidate candidate = finalist.candidate;
  candidate.others = finalist.fit.values.head(first);
  const Eigen::Index free = finalist.fit.values.size() - first;
  candidate.start.head(free) = finalist.fit.values.tail(free);
  return candidate;
}

}  // namespace

EffectFitProblem Selector::with(EffectFitProblem problem, const Candidate& candidate) {
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
    Finalist& finalist = finalists[i];
    finalist.candidate = candidates[i];
    finalist.problem = with(problem_, candidates[i]);
    finalist.problem.scales = scales;
    finalist.problem.max_iterations = kFinalistIterations;
    finalist.problem.tolerance = kFinalistTolerance;
    finalist.problem.frozen = fit_.jacobian;
    finalist.problem.with_covariance = false;
    finalist.fit = fitEffects(finalist.problem);
    finalist.problem.frozen.resize(0, 0);
    finalist.most = rule_.compare(held_out_, finalist.fit.residual).share;
  });
  const auto ends_at_bound = [&](const Finalist& finalist) {
    return endsAtBound(finalist.candidate.hypothesis, finalist.fit, fit_.values.size());
  };
  finalists.erase(std::remove_if(finalists.begin(), finalists.end(), ends_at_bound),
                  finalists.end());
  std::stable_sort(finalists.begin(), finalists.end(),
                   [](const Finalist& a, const Finalist& b) { return a.most > b.most; });
  return finalists;
}

const Finalist* Selector::choose(std::vector<Finalist>& finalists, Member& member) const {
  for (std::size_t held_out = 0; held_out < finalists.size();) {
    const std::size_t first = held_out;
    held_out = std::min(held_out + kAtOnce, finalists.size());
    parallelFor(static_cast<int>(held_out - first), [&](int index) {
      Finalist& finalist = finalists[first + static_cast<std::size_t>(index)];
      finalist.held_out = heldOutResiduals(finalist.problem, finalist.fit, options_.folds);
      finalist.gain = rule_.compare(held_out_, finalist.held_out).share;
    });
    // Is any of the others still needed, whose gain is no more than that?
    const double most = held_out < finalists.size() ? finalists[held_out].most : 0.0;
    const Choice choice = chooseAmong(finalists, held_out);
    if (held_out < finalists.size() &&
        (choice.best ? most > choice.next_gain || most >= kTieShare * choice.best->gain
                     : most >= options_.least_share))
      continue;
    if (!choice.best) return nullptr;
    member.hypothesis = choice.simplest->candidate.hypothesis;
    for (const Finalist* equal : choice.equal)
      if (equal != choice.simplest && member.equals.size() < kMostEquals)
        member.equals.push_back(fitted(*equal, fit_.values.size()));
    if (choice.next) {
      member.has_runner_up = true;
      member.runner_up = choice.next->candidate.hypothesis;
      member.runner_up_share = choice.next_gain / std::max(choice.simplest->gain, 1e-12);
    }
    return choice.simplest;
  }
  return nullptr;
}

Selector::Choice Selector::chooseAmong(const std::vector<Finalist>& finalists,
                                       std::size_t count) const {
  Choice choice;
  const auto end = finalists.begin() + static_cast<std::ptrdiff_t>(count);
  for (auto finalist = finalists.begin(); finalist != end; ++finalist)
    if ((!choice.best || finalist->gain > choice.best->gain) &&
        rule_.earns(held_out_, finalist->held_out))
      choice.best = &*finalist;
  if (!choice.best) return choice;
  for (auto finalist = finalists.begin(); finalist != end; ++finalist) {
    // At the scale of what the best one leaves, small differences show.
    const Eigen::VectorXd& better = choice.best->held_out;
    const LossComparison worse = rule_.compare(finalist->held_out, better, better);
    if (&*finalist == choice.best ||
        (worse.z_mean <= Rival::kTie && finalist->gain >= kTieShare * choice.best->gain)) {
      choice.equal.push_back(&*finalist);
    } else if (finalist->gain > choice.next_gain) {
      choice.next = &*finalist;
      choice.next_gain = finalist->gain;
    }
  }
  const auto simpler = [](const Finalist* a, const Finalist* b) {
    const std::size_t pa = a->candidate.hypothesis.parameters.size();
    const std::size_t pb = b->candidate.hypothesis.parameters.size();
    return pa != pb ? pa < pb : a->gain > b->gain;
  };
  std::sort(choice.equal.begin(), choice.equal.end(), simpler);
  choice.simplest =
      *std::find_if(choice.equal.begin(), choice.equal.end(), [&](const Finalist* finalist) {
        return finalist == choice.best || rule_.earns(held_out_, finalist->held_out);
      });
  return choice;
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
  if (!choice) {  // what is too weak alone may not be together
    finalists = tryHypotheses(round, false, openGroups());
    choice = choose(finalists, member);
    member.together = true;
  }
  if (!choice) return false;
  const Finalist& chosen = *choice;
  member.first = static_cast<Eigen::Index>(problem_.parameters.size());
  problem_ = with(problem_, fitted(chosen, member.first));
  member.count = chosen.fit.values.size() - member.first;
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
