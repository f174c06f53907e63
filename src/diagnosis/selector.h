// SPDX-License-Identifier: BSD-3-Clause
// The state of a selection (selection.h): the causes so far, their fit, and what may still be
// added to or removed from them. Adding is adding_causes.cpp, removing removing_causes.cpp, single
// parameters trimming_causes.cpp, what else explains as much comparing_rivals.cpp.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "raven_correction/diagnosis/claim.h"
#include "raven_correction/diagnosis/screening.h"
#include "raven_correction/diagnosis/selection.h"

namespace raven_correction {

/// A cause in the fit: its free parameters are `count` of the fit's, from `first`.
struct Member {
  Hypothesis hypothesis;
  Eigen::Index first = 0, count = 0;
  bool together = false;          // of togetherHypotheses()
  std::vector<Candidate> equals;  // when it was added, with the values that they had then
  bool has_runner_up = false;
  Hypothesis runner_up;
  double runner_up_share = 0.0;
  double share = 0.0;  // when it was last dropped
  bool stays = false;  // its derivatives say that it may go, a fit without it says that it may not
};

/// The fit without one cause.
struct Dropped {
  Eigen::VectorXd others;  // values of the parameters that are left; empty: no fit was made
  Eigen::VectorXd held_out;
};

/// How far the others are fitted again when a cause is dropped. kLinear: by their derivatives
/// alone, which finds most of what does not earn its place. kLast: as far as the fit with all of
/// them, so that the cause is judged by what it adds and not by the effort.
enum class Effort { kLinear, kLast };

/// A hypothesis after its fit.
struct Finalist {
  Candidate candidate;
  EffectFitProblem problem;
  EffectFit fit;
  double most = 0.0;         // share of the held-out loss so far that its fit to all motions gains
  Eigen::VectorXd held_out;  // empty: not needed, because of how little that is
  double gain = 0.0;         // of held-out motions: no more than `most`
};

// Two explanations of held-out motions cannot be told apart with z (LossComparison) up to
// Rival::kTie, or where what they predict differs by less than a log likelihood of kTie^2 / 2, if
// the lesser one explains at least kTieShare of what the better does.
constexpr double kTieShare = 0.9;

/// Whether they have a parameter in common.
bool overlaps(const Hypothesis& a, const Hypothesis& b);

/// These parameters, of one effect, at nothing. What does not have the effect does not get it: an
/// effect of no size can still make the load needed, and with it a simulation step by step.
SimulationConfig withoutParameters(const SimulationConfig& simulation,
                                   const std::vector<ParameterHandle>& parameters);

class Selector {
 public:
  Selector(const Recording& recording, const ResidualLayout& layout,
           const SimulationConfig& simulation, const SelectionOptions& options,
           const DiagnosisProgress& progress);
  SelectionResult run();

 private:
  void say(const std::string& phase, double fraction) const;
  void refit();

  // adding_causes.cpp
  /// A fit and one more hypothesis, which begins at the candidate's points.
  static EffectFitProblem with(EffectFitProblem problem, const Candidate& candidate);
  /// The value of one of its amplitudes, from `first` of the fit, has run into the end of its
  /// range.
  bool endsAtBound(const Hypothesis& hypothesis, const EffectFit& fit, Eigen::Index first) const;
  /// Those whose amplitudes end within their ranges: what needs more than may be is something else.
  /// What explains the most of the motions that it is fitted to comes first.
  std::vector<Finalist> fitFinalists(std::vector<Candidate> candidates) const;
  struct Choice {
    const Finalist* best = nullptr;      // the largest gain that earns its place; null: none does
    std::vector<const Finalist*> equal;  // explain as much, with `best`, the simplest first
    const Finalist* simplest = nullptr;  // of these, that earns its place
    const Finalist* next = nullptr;      // the best of the others
    double next_gain = 0.0;
  };
  /// The best that earns its place; of those that explain the held-out motions as well as that one
  /// the one with the fewest parameters. Null if none does. Simulates held-out motions of as many
  /// finalists as it takes to know, where none is taken to gain more of them than of motions that
  /// it is fitted to.
  const Finalist* choose(std::vector<Finalist>& finalists, Member& member) const;
  Choice chooseAmong(const std::vector<Finalist>& finalists, std::size_t count) const;
  /// Hypotheses that are not in the fit; of these the promising ones only, unless `all`.
  std::vector<Hypothesis> openHypotheses(bool all) const;
  /// Fits the best of the open hypotheses. What explains next to nothing does so in the next round,
  /// too, so not every round has to look at all.
  std::vector<Finalist> tryHypotheses(int round, bool all);
  std::vector<Finalist> tryHypotheses(int round, bool all, const std::vector<Hypothesis>& open);
  bool add(int round);
  /// togetherHypotheses() of what is open, as far as max_causes leaves room for their parts.
  std::vector<Hypothesis> openGroups() const;
  /// Couplings into several joints are a cause for each of these, to be judged on its own; what
  /// explains as much as all of them does not explain as much as one.
  void addMembers(Member member);

  // removing_causes.cpp
  /// The fit without one cause, all others free to make up for it.
  EffectFitProblem without(const Member& member) const;
  /// Fits in passes until the loss falls no more.
  /// @param residual  at its start
  EffectFit fitInPasses(EffectFitProblem& problem, Eigen::VectorXd residual) const;
  /// One cause dropped and the others fitted again until the loss falls no more, from where their
  /// derivatives lead or from where they are.
  Dropped drop(const Member& member, const LinearHeldOut& linear) const;
  static LinearHeldOut::Dropped droppedOf(const Member& member);
  /// A limit of nothing is none, which no derivative knows.
  bool isLinear(const Member& member) const;
  /// Drops each of these causes on its own.
  void dropEach(const std::vector<std::size_t>& members, Effort effort);
  /// Of these causes the one that earns its place least; members_.size() if all earn it.
  std::size_t weakestOf(const std::vector<std::size_t>& members) const;
  /// All causes, or those only that explained little when they were last dropped.
  std::vector<std::size_t> membersToDrop(bool all) const;
  /// Whether a cause does not earn its place with the others fitted again, either. Else it stays.
  bool isConfirmed(std::size_t weakest);
  /// Removes causes that do not earn their place, the weakest first; in the end each of those that
  /// stay has been dropped beside all the others.
  void removeWeak(Effort effort);
  void remove(std::size_t weakest);

  // trimming_causes.cpp
  /// Takes those parameters out of groups whose values may as well be nothing, the most doubtful
  /// first, until all that are left are beyond doubt in one fit. Each group keeps at least one:
  /// whether it goes as a whole is for removeWeak() to say.
  void trimGroups();
  bool takeOutMostDoubtful();
  /// Takes causes out, or single parameters of a group, whose amplitude has run into the end of its
  /// range: the best value is none that can be, so the cause is another one. They are not tried
  /// again.
  void releaseAtBounds();
  bool isAtBound(const ParameterHandle& handle, double value) const;
  /// Takes one parameter out of a cause of several; the others follow by their derivatives alone.
  void takeOut(Member& member, Eigen::Index parameter);

  // comparing_rivals.cpp
  /// A hypothesis that has become a cause itself is no rival any more.
  bool isMember(const Hypothesis& hypothesis) const;
  /// A rival in the place of a member, with all others fitted again. Null where no value within its
  /// range suits, or where the held-out motions tell them apart after all.
  std::unique_ptr<Rival> compareWith(const Candidate& equal, const Member& member,
                                     const Dropped& dropped) const;
  /// For each member those of its equals that are still none of the causes and still equal.
  std::vector<std::vector<Rival>> rivals() const;

  /// @param dropped  held-out residual without it
  Cause describe(const Member& member, const Eigen::VectorXd& dropped,
                 std::vector<Rival> rivals) const;
  void finish();

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
  std::vector<Hypothesis> released_;  // see releaseAtBounds()
  std::vector<Dropped> dropped_;      // see dropEach()
  Eigen::VectorXd kept_;              // held-out residual to compare them with
  SelectionResult result_;
};

}  // namespace raven_correction
