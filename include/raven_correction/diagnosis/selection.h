// SPDX-License-Identifier: BSD-3-Clause
// Which causes the recording supports: hypotheses are added one by one, the best on motions that it
// was not fitted to, as long as they earn their place; then those that no longer do are removed.
// What a hypothesis is, is hypothesis.h; the whole diagnosis is diagnose.h.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "raven_correction/diagnosis/held_out.h"
#include "raven_correction/diagnosis/hypothesis.h"

namespace raven_correction {

struct SelectionOptions {
  int folds = 5;  ///< motion i is held out in fold i % folds
  int max_causes = 32;
  int finalists = 8;  ///< hypotheses of a round that are fitted; the others were screened
  /// Chance of a false claim on data without any effect that the threshold aims at, shared over all
  /// hypotheses and starts [-]. How often it happens is what `bench diagnosis` counts.
  double significance = 0.01;
  double least_share = 0.004;  ///< of the held-out loss that a cause must explain [-]
  std::uint64_t seed = 1;
};

/// A hypothesis that, in the place of a cause and with all other causes fitted again, explains the
/// held-out motions as well.
struct Rival {
  /// Two explanations cannot be told apart with |z| up to this [-].
  static constexpr double kTie = 2.0;
  /// The held-out motions speak for the rival rather than for the cause, which is the simpler one.
  bool isAhead() const noexcept { return z < -kTie; }

  Hypothesis hypothesis;
  Eigen::VectorXd values, deviations;  ///< what its parameters would be, as in Cause
  double relative_gain = 0.0;  ///< of the held-out loss without the cause, over the cause's own [-]
  /// Mean difference of the motions' held-out losses over its standard error; above 0 the cause is
  /// ahead, below the rival [-].
  double z = 0.0;
  /// Log likelihood of the held-out motions with the cause, less that with the rival
  /// (ClaimRule::logLikelihood()) [-].
  double log_likelihood = 0.0;
  /// What that difference would be on average if the cause were the truth: half the squared
  /// distance of the two predictions in units of what is left. It is the information that this
  /// recording has to tell them apart; with little of it no method could [-].
  double log_likelihood_expected = 0.0;
};

/// A hypothesis that earned its place.
struct Cause {
  Hypothesis hypothesis;
  Eigen::VectorXd values;  ///< of its parameters
  /// One standard deviation each; of a fixed shape as its likelihood has it (profileDeviation()).
  Eigen::VectorXd deviations;
  /// Share of the held-out loss that is there when this cause is dropped and all others are
  /// refitted, which goes when it is in, and its 95 % interval over motions [-].
  double share = 0.0, lower = 0.0, upper = 0.0;
  std::vector<Rival> equals;  ///< explain the held-out motions as well; at most three
  bool has_runner_up = false;
  Hypothesis runner_up;          ///< the best of the others when this one was chosen
  double runner_up_share = 0.0;  ///< of the loss at that moment, of this cause's own [-]
};

struct SelectionResult {
  std::vector<Cause> causes;          ///< largest share first
  SimulationConfig simulation;        ///< with the causes, values and deviations
  Eigen::VectorXd nominal_residual;   ///< before any cause
  Eigen::VectorXd fitted_residual;    ///< of the fit to all motions
  Eigen::VectorXd held_out_residual;  ///< see heldOutResiduals()
  SimulatedSamples held_out;          ///< what the simulations that left it say
  bool converged = true;              ///< the last fit of all causes
  bool stopped_at_most = false;       ///< max_causes were in, so no further one was tried
  std::size_t hypotheses = 0;         ///< tried in the first round
  std::size_t starts = 0;             ///< of their fits, periods and instants included
};

/// Called with what is going on and how far it is, in [0, 1].
using DiagnosisProgress = std::function<void(const std::string& phase, double fraction)>;

/// Forward selection with removal, each step judged on held-out residuals (ClaimRule): screen() all
/// hypotheses, fit the finalists beside the causes so far, take the best that earns its place, fit
/// all again; when none does, fit to the end, and drop each cause in turn with all others fitted to
/// the end, too. What does not earn its place then goes, the weakest first.
/// @param layout      of the recording
/// @param simulation  what is believed so far; its effects stay as they are
/// @param progress    called from the calling thread before every pass; what it throws ends the
/// work
/// @return residuals have layout.size numbers; without causes all three are the same
/// @throws InvalidInput  fewer motions than folds, or fewer than two folds
/// Source of the steps: Efroymson 1960, Multiple regression analysis, in Ralston, Wilf (eds.),
///         Mathematical methods for digital computers
SelectionResult selectCauses(const Recording& recording, const ResidualLayout& layout,
                             const SimulationConfig& simulation, const SelectionOptions& options,
                             const DiagnosisProgress& progress = {});

}  // namespace raven_correction
