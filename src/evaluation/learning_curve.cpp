// SPDX-License-Identifier: BSD-3-Clause
#include "raven_correction/evaluation/learning_curve.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <numeric>

#include "raven_correction/error.h"
#include "raven_correction/geometry/statistics.h"

namespace raven_correction {

const char* curveMethodName(CurveMethod method) noexcept {
  switch (method) {
    case CurveMethod::kNone:
      return "none";
    case CurveMethod::kRigid:
      return "rigid";
    case CurveMethod::kPhysics:
      return "physics";
    case CurveMethod::kRegression:
      return "regression";
    case CurveMethod::kPhysicsRegression:
      break;
  }
  return "physics_regression";
}

namespace {

/// Sums over the states of one held-out trajectory.
struct TrajectorySums {
  double count = 0.0;
  Eigen::Vector2d alone = Eigen::Vector2d::Zero();    // length [m], angle [rad]: regression alone
  Eigen::Vector2d physics = Eigen::Vector2d::Zero();  // with physics
};

void check(const Dataset& dataset, const LearningCurveProblem& problem) {
  const auto folds = static_cast<std::size_t>(problem.folds);
  if (dataset.trajectories.size() < folds)
    throw InvalidInput(format("%s: %zu trajectories, at least %d are needed for %d folds",
                              dataset.source.c_str(), dataset.trajectories.size(), problem.folds,
                              problem.folds));
  if (problem.simulations.size() > 1 && problem.simulations.size() != folds)
    throw InvalidInput(format("%zu simulations for %d folds; give one, or one per fold in order",
                              problem.simulations.size(), problem.folds));
  for (const int fold : problem.only_folds)
    if (fold < 0 || fold >= problem.folds)
      throw InvalidInput(format("there is no fold %d of %d", fold, problem.folds));
  for (std::size_t i = 0; i < problem.pairs.size(); ++i)
    if (problem.pairs[i] < 10 || (i > 0 && problem.pairs[i] <= problem.pairs[i - 1]))
      throw InvalidInput(
          format("numbers of pairs must increase from at least 10; number %zu is %zu", i + 1,
                 problem.pairs[i]));
  if (problem.pairs.empty()) throw InvalidInput("no number of pairs to learn from");
}

/// Everything about one fold that the number of pairs does not change.
class Fold {
 public:
  Fold(const Dataset& dataset, const LearningCurveProblem& problem, int fold)
      : problem_(problem),
        training_(selectFold(dataset, {fold, problem.folds}, false)),
        test_(selectFold(dataset, {fold, problem.folds}, true)),
        simulation_(simulationOf(problem, static_cast<std::size_t>(fold))) {
    TrainingConfig config = problem.config;
    config.process_enabled = false;
    config.simulation = nullptr;
    config.max_pairs = 0;
    rigid_ = train(training_, config, 0.0).model;
    config.simulation = simulation_;
    if (simulation_) physics_ = train(training_, config, 0.0);
    max_gap_ = commandGapLimit(training_, config);
    clean_ = cleanStates(statesOf(rigid_), rigid_.rigid, problem.gates);
    if (std::find(clean_.begin(), clean_.end(), true) == clean_.end())
      throw InvalidInput(
          format("%s: no test state of fold %d passes the gates of the clean set; are commands and "
                 "observations in the same frame and in metres?",
                 test_.source.c_str(), fold));
    for (const TestState& state : statesOf(rigid_)) trajectory_of_.push_back(state.trajectory);
  }

  const Correction& rigid() const { return rigid_; }
  const TrainingResult& physics() const { return physics_; }
  std::size_t tests() const { return test_.trajectories.size(); }

  TrainingResult learn(std::size_t pairs, bool with_physics) const {
    TrainingConfig config = problem_.config;
    config.simulation = with_physics ? simulation_ : nullptr;
    config.max_pairs = pairs;
    config.draw = problem_.draw;
    config.process.seed = problem_.seed;
    config.process.max_exact_points =
        std::max(config.process.max_exact_points, static_cast<int>(pairs));
    return train(training_, config, 0.0);
  }

  /// Of the clean states; the same ones for every model, because all have the same delay.
  std::vector<PoseError> errors(const Correction& model, PredictionKind kind) const {
    const Predictor predictor(model);
    return pick(errorsOf(statesOf(model), kind, &predictor), clean_);
  }

  /// Index of the trajectory of each clean state.
  std::vector<std::size_t> trajectories() const {
    std::vector<std::size_t> of;
    for (std::size_t i = 0; i < clean_.size(); ++i)
      if (clean_[i]) of.push_back(trajectory_of_[i]);
    return of;
  }

 private:
  static std::shared_ptr<const SimulationConfig> simulationOf(const LearningCurveProblem& problem,
                                                              std::size_t fold) {
    if (problem.simulations.empty()) return nullptr;
    return problem.simulations[problem.simulations.size() == 1 ? 0 : fold];
  }
  std::vector<TestState> statesOf(const Correction& model) const {
    return makeTestStates(test_, model.motion, model.delay, max_gap_, problem_.gates);
  }

  const LearningCurveProblem& problem_;
  Dataset training_, test_;
  std::shared_ptr<const SimulationConfig> simulation_;
  Correction rigid_;
  TrainingResult physics_;
  double max_gap_ = 0.0;
  std::vector<bool> clean_;
  std::vector<std::size_t> trajectory_of_;
};

/// Where the curve of regression alone comes down to `error`.
double pairsFor(double error, const std::vector<std::size_t>& pairs,
                const std::vector<double>& curve) {
  if (error >= curve.front()) return error == curve.front() ? static_cast<double>(pairs[0]) : 0.0;
  for (std::size_t i = 1; i < curve.size(); ++i) {
    if (error < curve[i]) continue;
    const double share =
        (std::log(curve[i - 1]) - std::log(error)) / (std::log(curve[i - 1]) - std::log(curve[i]));
    const double low = std::log(static_cast<double>(pairs[i - 1]));
    return std::exp(low + share * (std::log(static_cast<double>(pairs[i])) - low));
  }
  return std::numeric_limits<double>::infinity();
}

Eigen::Vector2d ratioOf(const std::vector<TrajectorySums>& sums,
                        const std::vector<std::size_t>& chosen) {
  Eigen::Vector2d alone = Eigen::Vector2d::Zero(), physics = alone;
  for (const std::size_t i : chosen) {
    alone += sums[i].alone;
    physics += sums[i].physics;
  }
  return physics.cwiseQuotient(alone);
}

void compare(const std::vector<TrajectorySums>& sums, const LearningCurveProblem& problem,
             PairsSaved& saved) {
  std::vector<std::size_t> all(sums.size());
  std::iota(all.begin(), all.end(), std::size_t{0});
  const Eigen::Vector2d ratio = ratioOf(sums, all);
  saved.position_ratio = ratio(0);
  saved.angle_ratio = ratio(1);
  std::vector<double> positions, angles;
  bootstrapOverGroups(sums.size(), problem.resamples, problem.seed,
                      [&](const std::vector<std::size_t>& drawn) {
                        const Eigen::Vector2d again = ratioOf(sums, drawn);
                        positions.push_back(again(0));
                        angles.push_back(again(1));
                      });
  if (positions.empty()) return;
  const Interval position = interval95(positions), angle = interval95(angles);
  saved.position_lower = position.lower;
  saved.position_upper = position.upper;
  saved.angle_lower = angle.lower;
  saved.angle_upper = angle.upper;
}

/// Which methods depend on the number of pairs, in the order of the rows.
std::vector<CurveMethod> learners(bool physics) {
  if (physics) return {CurveMethod::kRegression, CurveMethod::kPhysicsRegression};
  return {CurveMethod::kRegression};
}

std::vector<LearningCurveRow> emptyRows(const LearningCurveProblem& problem) {
  const bool physics = !problem.simulations.empty();
  std::vector<CurveMethod> fixed{CurveMethod::kNone, CurveMethod::kRigid};
  if (physics) fixed.push_back(CurveMethod::kPhysics);
  std::vector<LearningCurveRow> rows;
  LearningCurveRow row;
  for (const CurveMethod method : fixed) {
    row.method = method;
    rows.push_back(row);
  }
  for (const std::size_t pairs : problem.pairs)
    for (const CurveMethod method : learners(physics)) {
      row.method = method;
      row.pairs = pairs;
      rows.push_back(row);
    }
  return rows;
}

/// What physics saves, by number of pairs. @param sums  by number of pairs, then held-out
/// trajectory
std::vector<PairsSaved> pairsSaved(const LearningCurveProblem& problem,
                                   const std::vector<LearningCurveRow>& rows,
                                   std::vector<std::vector<TrajectorySums>>& sums) {
  std::vector<double> position_curve, angle_curve;
  for (std::size_t p = 0; p < problem.pairs.size(); ++p) {
    position_curve.push_back(rows[3 + 2 * p].errors.position_norm);
    angle_curve.push_back(rows[3 + 2 * p].errors.angle_norm);
  }
  std::vector<PairsSaved> all;
  for (std::size_t p = 0; p < problem.pairs.size(); ++p) {
    PairsSaved saved;
    saved.pairs = problem.pairs[p];
    const ErrorSummary& errors = rows[4 + 2 * p].errors;
    saved.position_pairs = pairsFor(errors.position_norm, problem.pairs, position_curve);
    saved.angle_pairs = pairsFor(errors.angle_norm, problem.pairs, angle_curve);
    std::vector<TrajectorySums>& of = sums[p];
    of.erase(std::remove_if(of.begin(), of.end(),
                            [](const TrajectorySums& sum) { return sum.count == 0.0; }),
             of.end());
    compare(of, problem, saved);
    all.push_back(saved);
  }
  return all;
}

}  // namespace

LearningCurveResult learningCurve(const Dataset& dataset, const LearningCurveProblem& problem,
                                  const Progress& progress) {
  check(dataset, problem);
  std::vector<int> folds = problem.only_folds;
  if (folds.empty()) {
    folds.resize(static_cast<std::size_t>(problem.folds));
    std::iota(folds.begin(), folds.end(), 0);
  }
  LearningCurveResult result;
  for (const auto& simulation : problem.simulations) result.simulations.push_back(simulation->name);
  result.rows = emptyRows(problem);
  const bool physics = !problem.simulations.empty();
  std::vector<std::vector<TrajectorySums>> sums(problem.pairs.size());

  const double steps = static_cast<double>(folds.size()) *
                       static_cast<double>(1 + learners(physics).size() * problem.pairs.size());
  double done = 0.0;
  for (const int k : folds) {
    const auto report = [&](const std::string& what) {
      if (progress)
        progress(format("fold %d/%d, %s", k, problem.folds, what.c_str()), done / steps);
      done += 1.0;
    };
    report(physics ? "rigid and physics" : "rigid");
    const Fold fold(dataset, problem, k);
    result.trajectories += fold.tests();
    result.out_of_reach += fold.physics().out_of_reach;
    const std::vector<std::size_t> trajectories = fold.trajectories();
    auto row = result.rows.begin();
    const auto add = [&](const std::vector<PoseError>& errors, std::size_t n_train,
                         double seconds = 0.0) {
      row->folds.push_back(summarise(errors));
      row->n_train += n_train;
      row->train_seconds += seconds;
      ++row;
    };
    add(fold.errors(fold.rigid(), PredictionKind::kNone), 0);
    add(fold.errors(fold.rigid(), PredictionKind::kRigid), fold.rigid().training_pairs);
    if (physics) add(fold.errors(fold.physics().model, PredictionKind::kFull), 0);
    for (std::size_t p = 0; p < problem.pairs.size(); ++p) {
      const std::size_t first = sums[p].size();
      sums[p].resize(first + fold.tests());
      for (const CurveMethod method : learners(physics)) {
        const bool with_physics = method == CurveMethod::kPhysicsRegression;
        report(format("%zu pairs%s", problem.pairs[p], with_physics ? " and physics" : ""));
        const auto begin = std::chrono::steady_clock::now();
        const TrainingResult learnt = fold.learn(problem.pairs[p], with_physics);
        const std::chrono::duration<double> taken = std::chrono::steady_clock::now() - begin;
        const std::vector<PoseError> errors = fold.errors(learnt.model, PredictionKind::kFull);
        add(errors, learnt.model.training_pairs, taken.count());
        for (std::size_t i = 0; i < errors.size(); ++i) {
          TrajectorySums& sum = sums[p][first + trajectories[i]];
          (with_physics ? sum.physics : sum.alone) +=
              Eigen::Vector2d(errors[i].components.head<3>().norm(), errors[i].angle);
          sum.count += 1.0;
        }
      }
    }
  }
  for (LearningCurveRow& row : result.rows) {
    row.errors = meanOf(row.folds);
    row.n_train /= row.folds.size();
    row.train_seconds /= static_cast<double>(row.folds.size());
  }
  if (physics) result.saved = pairsSaved(problem, result.rows, sums);
  if (progress) progress("done", 1.0);
  return result;
}

}  // namespace raven_correction
