// SPDX-License-Identifier: BSD-3-Clause
// Errors on trajectories left out, and the time of training, against the number of training pairs:
// of regression alone (the paper's Fig. 5), and, with a simulation, of regression about it, and how
// many pairs the simulation saves. All pairs and all methods of the paper are table_one.h.
#pragma once

#include <memory>
#include <vector>

#include "raven_correction/correction/training.h"
#include "raven_correction/evaluation/error_metrics.h"
#include "raven_correction/evaluation/test_states.h"

namespace raven_correction {

enum class CurveMethod {
  kNone,               ///< the command as the planner gave it
  kRigid,              ///< rigid transform from all pairs
  kPhysics,            ///< the way back through the simulation alone: learns nothing
  kRegression,         ///< rigid transform and process from so many pairs
  kPhysicsRegression,  ///< the simulation and, about it, the process from the same pairs
};
/// "none", "rigid", "physics", "regression", "physics_regression".
const char* curveMethodName(CurveMethod method) noexcept;

struct LearningCurveProblem {
  TrainingConfig config;  ///< of every training; its simulation, max_pairs and draw are not used
  /// One per fold, or one for all; empty: regression alone. Figures are honest only if none was
  /// fitted to what its fold tests on.
  std::vector<std::shared_ptr<const SimulationConfig>> simulations;
  std::vector<std::size_t> pairs{100, 300, 1000, 4000};  ///< increasing
  TrainingConfig::Draw draw = TrainingConfig::Draw::kPairs;
  int folds = 5;                ///< trajectory i tests in fold i % folds
  std::vector<int> only_folds;  ///< of these; empty: all
  int resamples = 1000;         ///< of the bootstrap over trajectories
  std::uint64_t seed = 1;       ///< of draws and bootstrap
  CleanGates gates;
};

struct LearningCurveRow {
  CurveMethod method = CurveMethod::kNone;
  std::size_t pairs = 0;       ///< asked for; 0 for methods that do not depend on it
  std::size_t n_train = 0;     ///< learnt from, mean over folds
  double train_seconds = 0.0;  ///< synchronising, cleaning and fitting, mean over folds [s]
  ErrorSummary errors;         ///< clean held-out states; means over folds
  std::vector<ErrorSummary> folds;
};

/// Physics and regression against regression alone, with as many pairs.
struct PairsSaved {
  std::size_t pairs = 0;
  /// Mean error with physics over that without, over all held-out states, and its 95 % interval
  /// over trajectories [-].
  double position_ratio = 0.0, position_lower = 0.0, position_upper = 0.0;
  double angle_ratio = 0.0, angle_lower = 0.0, angle_upper = 0.0;
  /// Pairs with which regression alone is as good (norm of the mean absolute errors), by its
  /// curve, straight between logarithms; infinite: more than the curve has; 0: fewer. [1]
  double position_pairs = 0.0, angle_pairs = 0.0;
};

struct LearningCurveResult {
  std::vector<LearningCurveRow> rows;  ///< none, rigid, physics if there is; then by pairs
  std::vector<PairsSaved> saved;       ///< one per number of pairs; empty without physics
  std::size_t trajectories = 0;        ///< held out in some fold
  std::size_t out_of_reach = 0;  ///< training pairs that a simulation does not reach, all folds
  std::vector<std::string> simulations;
};

/// @throws InvalidInput  fewer trajectories than folds, as many simulations as neither one nor
/// folds,
///         numbers of pairs that do not increase, or see train()
LearningCurveResult learningCurve(const Dataset& dataset, const LearningCurveProblem& problem,
                                  const Progress& progress = {});

}  // namespace raven_correction
