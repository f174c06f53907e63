// SPDX-License-Identifier: BSD-3-Clause
#include "raven_correction/diagnosis/selection.h"

#include <algorithm>
#include <numeric>

#include "parallel.h"
#include "raven_correction/diagnosis/claim.h"
#include "raven_correction/diagnosis/noise_floor.h"
#include "raven_correction/diagnosis/screening.h"
#include "raven_correction/error.h"

namespace raven_correction {
namespace {

constexpr int kFinalistIterations = 5;
constexpr double kFinalistTolerance = 1e-4;
constexpr int kRefitIterations = 4;  // of a round: the next one goes on from there
constexpr double kRefitTolerance = 1e-5;
constexpr int kLastIterations = 25;
constexpr double kLastTolerance = 1e-6;
constexpr int kDropIterations = 3;
constexpr int kRoundsOfAll = 4;         // every so many rounds all hypotheses are screened
constexpr std::size_t kPromising = 40;  // and so many of them in the rounds between
constexpr double kSameScales = 0.02;    // change of a channel's scale that needs no second fit [-]
constexpr double kSafe = 4.0;           // times the least share: it will not have to go [-]
constexpr double kTie = 2.0;            // z below which two explanations cannot be told apart
constexpr double kTieShare = 0.9;  // and the lesser one explains at least this part of the better
constexpr std::size_t kMostEquals = 3;
constexpr double kDoubtful = 2.0;  // deviations from nothing of a parameter that leaves its group

/// A cause in the fit: its free parameters are `count` of the fit's, from `first`.
struct Member {
  Hypothesis hypothesis;
  Eigen::Index first = 0, count = 0;
  bool together = false;  // of togetherHypotheses()
  std::vector<Hypothesis> equals;
  bool has_runner_up = false;
  Hypothesis runner_up;
  double runner_up_share = 0.0;
  double share = 0.0;  // when it was last dropped
};

/// How far the others are fitted again when a cause is dropped. kLinear: by their derivatives
/// alone, which finds most of what does not earn its place. kLast: as far as the fit with all of
/// them, so that the cause is judged by what it adds and not by the effort.
enum class Effort { kLinear, kLast };

/// A hypothesis after its fit.
struct Finalist {
  Candidate candidate;
  EffectFit fit;
  Eigen::VectorXd held_out;
};

bool overlaps(const Hypothesis& a, const Hypothesis& b) {
  for (const ParameterHandle& one : a.parameters)
    if (std::find(b.parameters.begin(), b.parameters.end(), one) != b.parameters.end()) return true;
  return false;
}

/// Hypotheses about what the simulation does not have yet: what it has stays as it is.
std::vector<Hypothesis> newHypotheses(const Recording& recording,
                                      const SimulationConfig& simulation) {
  std::vector<Hypothesis> all = allHypotheses(recording, simulation);
  const auto known = [&](const Hypothesis& hypothesis) {
    return std::any_of(hypothesis.parameters.begin(), hypothesis.parameters.end(),
                       [&](const ParameterHandle& handle) {
                         return parameterOf(simulation, handle).value != 0.0;
                       });
  };
  all.erase(std::remove_if(all.begin(), all.end(), known), all.end());
  return all;
}

class Selector {
 public:
  Selector(const Recording& recording, const ResidualLayout& layout,
           const SimulationConfig& simulation, const SelectionOptions& options,
           const DiagnosisProgress& progress)
      : recording_(recording),
        layout_(layout),
        options_(options),
        progress_(progress),
        summary_(summarise(recording)),
        rule_(layout, options.least_share, options.seed),
        hypotheses_(newHypotheses(recording, simulation)) {
    problem_.recording = &recording;
    problem_.layout = &layout;
    problem_.simulation = simulation;
    problem_.max_iterations = kRefitIterations;
    problem_.tolerance = kRefitTolerance;
    fit_.residual = residuals(recording, layout, simulation, &result_.held_out);
    fit_.values.resize(0);
    fit_.jacobian.resize(layout.size, 0);
    held_out_ = fit_.residual;
    rule_.setNoise(noiseFloor(recording, simulation));
    result_.nominal_residual = fit_.residual;
    result_.hypotheses = hypotheses_.size();
  }

  SelectionResult run() {
    int round = 0;
    while (static_cast<int>(members_.size()) < options_.max_causes && add(round)) ++round;
    removeWeak(Effort::kLinear);
    if (!members_.empty()) trimGroups();
    if (!members_.empty()) {  // nothing is added any more: to the end
      problem_.max_iterations = kLastIterations;
      problem_.tolerance = kLastTolerance;
      refit();
      removeWeak(Effort::kLast);
      result_.converged = fit_.converged;
    }
    say("writing the verdict", 0.97);
    finish();
    return std::move(result_);
  }

 private:
  void say(const std::string& phase, double fraction) const {
    if (progress_) progress_(phase, fraction);
  }

  /// The fit so far and one more hypothesis.
  EffectFitProblem with(const Candidate& candidate) const {
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

  std::vector<Finalist> fitFinalists(std::vector<Candidate> candidates) const {
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
      finalists[i].candidate = candidates[i];
      finalists[i].fit = fitEffects(problem);
      finalists[i].held_out = heldOutResiduals(problem, finalists[i].fit, options_.folds);
    });
    return finalists;
  }

  /// The best that earns its place; of those that explain the held-out motions as well as that one
  /// the one with the fewest parameters. Null if none does.
  const Finalist* choose(const std::vector<Finalist>& finalists, Member& member) const {
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

  /// Hypotheses that are not in the fit; of these the promising ones only, unless `all`.
  std::vector<Hypothesis> openHypotheses(bool all) const {
    std::vector<Hypothesis> open;
    for (const Hypothesis& hypothesis : all ? hypotheses_ : promising_) {
      const bool in = std::any_of(members_.begin(), members_.end(), [&](const Member& member) {
        return overlaps(member.hypothesis, hypothesis);
      });
      if (!in) open.push_back(hypothesis);
    }
    return open;
  }

  /// Fits the best of the open hypotheses. What explains next to nothing does so in the next round,
  /// too, so not every round has to look at all.
  std::vector<Finalist> tryHypotheses(int round, bool all) {
    return tryHypotheses(round, all, openHypotheses(all));
  }

  std::vector<Finalist> tryHypotheses(int round, bool all, const std::vector<Hypothesis>& open) {
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

  bool add(int round) {
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
      finalists =
          tryHypotheses(round, false, togetherHypotheses(openHypotheses(true), recording_.robot));
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
    return true;
  }

  /// Couplings into several joints are a cause for each of these, to be judged on its own.
  void addMembers(Member member) {
    if (!member.together) {
      members_.push_back(std::move(member));
      return;
    }
    Eigen::Index first = member.first;
    const Hypothesis whole = member.hypothesis;
    for (std::vector<ParameterHandle>& part : partsOf(whole, recording_.robot)) {
      member.first = first;
      member.count = static_cast<Eigen::Index>(part.size());
      member.hypothesis = hypothesisOf(std::move(part), recording_.robot);
      first += member.count;
      members_.push_back(member);
    }
  }

  void refit() {
    problem_.scales = channelScales(layout_, fit_.residual);
    problem_.frozen.resize(0, 0);
    fit_ = fitEffects(problem_);
    problem_.start = fit_.values;
    held_out_ = heldOutResiduals(problem_, fit_, options_.folds, &result_.held_out);
    rule_.setNoise(
        noiseFloor(recording_, withValues(problem_.simulation, problem_.parameters, fit_.values)));
  }

  /// The fit without one cause, all others free to make up for it.
  EffectFitProblem without(const Member& member) const {
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

  /// Held-out residual when one cause is dropped and the others are refitted, from where their
  /// derivatives lead or from where they are.
  Eigen::VectorXd drop(const Member& member, const LinearHeldOut& linear) const {
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

  static LinearHeldOut::Dropped droppedOf(const Member& member) {
    const auto shapes =
        static_cast<Eigen::Index>(member.hypothesis.shapes - member.hypothesis.fixed_shapes);
    return {member.first, member.count - shapes, member.count};
  }

  /// A limit of nothing is none, which no derivative knows.
  bool isLinear(const Member& member) const {
    const ParameterHandle& first = member.hypothesis.parameters.front();
    return !isLimit(first.effect, parameterOf(problem_.simulation, first).symbol);
  }

  /// Drops each of these causes on its own.
  void dropEach(const std::vector<std::size_t>& members, Effort effort) {
    dropped_.resize(members_.size());
    kept_ = held_out_;
    const LinearHeldOut linear(problem_, fit_, options_.folds);
    if (effort == Effort::kLinear) kept_ = linear.residual();
    parallelFor(static_cast<int>(members.size()), [&](int index) {
      const std::size_t i = members[static_cast<std::size_t>(index)];
      const Member& member = members_[i];
      dropped_[i] = effort == Effort::kLinear && isLinear(member)
                        ? linear.residual(droppedOf(member))
                        : drop(member, linear);
    });
  }

  /// Of these causes the one that earns its place least; members_.size() if all earn it.
  std::size_t weakestOf(const std::vector<std::size_t>& members) const {
    std::size_t weakest = members_.size();
    double least = 0.0;
    for (const std::size_t i : members) {
      const LossComparison comparison = rule_.compare(dropped_[i], kept_);
      if (rule_.earns(dropped_[i], kept_) ||
          (weakest < members_.size() && comparison.share >= least))
        continue;
      weakest = i;
      least = comparison.share;
    }
    return weakest;
  }

  /// All causes, or those only that explained little when they were last dropped.
  std::vector<std::size_t> membersToDrop(bool all) const {
    std::vector<std::size_t> some;
    for (std::size_t i = 0; i < members_.size(); ++i)
      if (all || members_[i].share < kSafe * options_.least_share) some.push_back(i);
    return some;
  }

  /// Removes causes that do not earn their place, the weakest first; in the end each of those that
  /// stay has been dropped beside all the others.
  void removeWeak(Effort effort) {
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

  void remove(std::size_t weakest) {
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

  /// Takes those parameters out of groups whose values may as well be nothing. Fits nothing.
  void trimGroups() {
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

  Cause describe(const Member& member, const Eigen::VectorXd& dropped) const {
    Cause cause;
    cause.hypothesis = member.hypothesis;
    const auto k = static_cast<Eigen::Index>(member.hypothesis.parameters.size());
    cause.values.resize(k);
    cause.deviations = Eigen::VectorXd::Zero(k);
    cause.values.head(member.count) = fit_.values.segment(member.first, member.count);
    cause.deviations.head(member.count) =
        fit_.covariance.diagonal().segment(member.first, member.count).cwiseSqrt();
    for (Eigen::Index i = member.count; i < k; ++i)
      cause.values(i) = parameterOf(problem_.simulation,
                                    member.hypothesis.parameters[static_cast<std::size_t>(i)])
                            .value;
    const LossComparison comparison = rule_.compare(dropped, held_out_);
    cause.share = comparison.share;
    cause.lower = comparison.lower;
    cause.upper = comparison.upper;
    // What has become a cause itself is no rival any more.
    const auto is_member = [&](const Hypothesis& hypothesis) {
      return std::any_of(members_.begin(), members_.end(), [&](const Member& other) {
        return overlaps(other.hypothesis, hypothesis);
      });
    };
    for (const Hypothesis& equal : member.equals)
      if (!is_member(equal)) cause.equals.push_back(equal);
    cause.has_runner_up = member.has_runner_up && !is_member(member.runner_up);
    cause.runner_up = member.runner_up;
    cause.runner_up_share = member.runner_up_share;
    return cause;
  }

  void finish() {
    result_.simulation = withValues(problem_.simulation, problem_.parameters, fit_.values);
    for (std::size_t i = 0; i < members_.size(); ++i)
      result_.causes.push_back(describe(members_[i], dropped_[i]));
    for (const Cause& cause : result_.causes) {
      std::unique_ptr<Effect> effect = result_.simulation.find(cause.hypothesis.effect)->clone();
      for (std::size_t i = 0; i < cause.hypothesis.parameters.size(); ++i)
        effect->setDeviation(cause.hypothesis.parameters[i].index,
                             cause.deviations(static_cast<Eigen::Index>(i)));
      result_.simulation.set(std::move(effect));
    }
    for (const Hypothesis& hypothesis : hypotheses_) {  // tried, and removed again
      const Effect* const effect = result_.simulation.find(hypothesis.effect);
      if (effect && std::all_of(effect->parameters().begin(), effect->parameters().end(),
                                [](const EffectParameter& p) { return p.value == 0.0; }))
        result_.simulation.remove(hypothesis.effect);
    }
    std::stable_sort(result_.causes.begin(), result_.causes.end(),
                     [](const Cause& a, const Cause& b) { return a.share > b.share; });
    result_.fitted_residual = fit_.residual;
    result_.held_out_residual = held_out_;
  }

  const Recording& recording_;
  const ResidualLayout& layout_;
  const SelectionOptions options_;
  const DiagnosisProgress& progress_;
  const RecordingSummary summary_;
  ClaimRule rule_;
  const std::vector<Hypothesis> hypotheses_;
  std::vector<Hypothesis> promising_;  // the best of the last time that all were screened
  EffectFitProblem problem_;           // the causes so far
  EffectFit fit_;
  Eigen::VectorXd held_out_;  // residual
  std::vector<Member> members_;
  std::vector<Eigen::VectorXd> dropped_;  // see dropEach()
  Eigen::VectorXd kept_;                  // held-out residual to compare them with
  SelectionResult result_;
};

}  // namespace

SelectionResult selectCauses(const Recording& recording, const ResidualLayout& layout,
                             const SimulationConfig& simulation, const SelectionOptions& options,
                             const DiagnosisProgress& progress) {
  if (options.folds < 2 || layout.motions < options.folds)
    throw InvalidInput(format("%s: %d motions, but %d folds; at least one motion is needed in each",
                              recording.name.c_str(), layout.motions, options.folds));
  return Selector(recording, layout, simulation, options, progress).run();
}

}  // namespace raven_correction
