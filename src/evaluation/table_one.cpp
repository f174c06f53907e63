// SPDX-License-Identifier: BSD-3-Clause
#include "raven_correction/evaluation/table_one.h"

#include "raven_correction/error.h"

namespace raven_correction {

const char* methodName(Method method) noexcept {
  switch (method) {
    case Method::kNone:
      return "none";
    case Method::kRigid:
      return "rigid";
    case Method::kRigidClean:
      return "rigid_clean";
    case Method::kRigidGp:
      return "rigid_gp";
    case Method::kRigidGpVelocity:
      return "rigid_gp_velocity";
    case Method::kRigidGpVelocityClean:
      return "rigid_gp_velocity_clean";
    case Method::kCount:
      break;
  }
  return "unknown";
}

TrainingConfig configOf(Method method, const TrainingConfig& config) {
  TrainingConfig reduced = config;
  reduced.simulation = nullptr;
  const bool cleans = method == Method::kRigidClean || method == Method::kRigidGpVelocityClean;
  const bool learns = method >= Method::kRigidGp;
  const bool moves = method >= Method::kRigidGpVelocity;
  reduced.cleaning_enabled = reduced.cleaning_enabled && cleans;
  reduced.process_enabled = reduced.process_enabled && learns;
  if (!moves) reduced.motion.velocity = VelocityKind::kNone;
  return reduced;
}

namespace {

constexpr Method kMethods[] = {
    Method::kNone,    Method::kRigid,           Method::kRigidClean,
    Method::kRigidGp, Method::kRigidGpVelocity, Method::kRigidGpVelocityClean};

/// Both test sets of one method on one split.
struct Rows {
  TableOneRow dirty, clean;
};

struct Split {
  const Dataset& training;
  const Dataset& test;
  const std::string& name;
  const TrainingConfig& config;
  const CleanGates& gates;
  int fold;
  const TableOneObserver& observer;
};

std::vector<Rows> rowsOf(const Split& split, const std::function<void(double)>& progress,
                         TrainingResult& last) {
  // The rigid step from cleaned training pairs decides what is clean, for every method alike.
  const TrainingResult rigid =
      train(split.training, configOf(Method::kRigidClean, split.config), 0.0);
  const double max_gap = commandGapLimit(split.training, split.config);
  std::vector<Rows> rows;
  for (const Method method : kMethods) {
    const TrainingConfig config = configOf(method, split.config);
    const bool none = method == Method::kNone;
    if (!none) last = train(split.training, config, 0.0);
    const std::vector<TestState> states =
        makeTestStates(split.test, config.motion, rigid.model.delay, max_gap, split.gates);
    const Predictor predictor(none ? Correction(rigid.model) : last.model);
    const PredictionKind kind = none                        ? PredictionKind::kNone
                                : method < Method::kRigidGp ? PredictionKind::kRigid
                                                            : PredictionKind::kFull;
    const std::vector<PoseError> errors = errorsOf(states, kind, &predictor);
    TableOneRow row;
    row.configuration = split.name;
    row.method = method;
    row.fold = split.fold;
    row.n_train = none ? 0 : last.model.training_pairs;
    Rows both{row, row};
    both.dirty.errors = summarise(errors);
    both.clean.clean = true;
    const std::vector<bool> is_clean = cleanStates(states, rigid.model.rigid, split.gates);
    const std::vector<PoseError> clean_errors = pick(errors, is_clean);
    both.clean.errors = summarise(clean_errors);
    if (split.observer) {
      std::vector<TestState> clean_states;
      for (std::size_t i = 0; i < states.size(); ++i)
        if (is_clean[i]) clean_states.push_back(states[i]);
      split.observer(both.dirty, states, errors);
      split.observer(both.clean, clean_states, clean_errors);
    }
    if (both.clean.errors.n == 0)
      throw InvalidInput(format(
          "%s: no test state passes the gates of the clean set (%zu states); are commands and "
          "observations in the same frame and in metres?",
          split.test.source.c_str(), errors.size()));
    rows.push_back(both);
    progress(static_cast<double>(rows.size()) / static_cast<double>(std::size(kMethods)));
  }
  return rows;
}

void append(const std::vector<Rows>& rows, std::vector<TableOneRow>& table) {
  for (const Rows& both : rows) table.push_back(both.dirty);
  for (const Rows& both : rows) table.push_back(both.clean);
}

TableOneRow meanRow(const std::vector<TableOneRow>& folds) {
  TableOneRow row = folds.front();
  std::vector<ErrorSummary> summaries;
  std::size_t n_train = 0;
  for (const TableOneRow& fold : folds) {
    summaries.push_back(fold.errors);
    n_train += fold.n_train;
  }
  row.fold = kMeanOfFolds;
  row.errors = meanOf(summaries);
  row.n_train = n_train / folds.size();
  return row;
}

/// Delay and cleaning of the whole data set, for the report.
void describeData(const Dataset& dataset, const TrainingConfig& config, TableOneResult& result) {
  const TrainingResult all = train(dataset, configOf(Method::kRigidClean, config), 0.0);
  result.delay = all.model.delay;
  result.fates = all.fates;
  result.identity_commands = all.identity_commands;
}

}  // namespace

const TableOneRow& TableOneResult::row(const std::string& configuration, Method method, bool clean,
                                       int fold) const {
  for (const TableOneRow& row : rows)
    if (row.configuration == configuration && row.method == method && row.clean == clean &&
        row.fold == fold)
      return row;
  throw InvalidInput(format("no row %s, %s, %s, fold %d", configuration.c_str(), methodName(method),
                            clean ? "clean" : "dirty", fold));
}

TableOneResult crossValidate(const Dataset& dataset, const TableOneProblem& problem,
                             const Progress& progress) {
  if (static_cast<int>(dataset.trajectories.size()) < problem.folds)
    throw InvalidInput(format(
        "%s: %zu trajectories, at least %d are needed for %d folds; record more, or give a test "
        "set of its own with --test",
        dataset.source.c_str(), dataset.trajectories.size(), problem.folds, problem.folds));
  TableOneResult result;
  const double parts = static_cast<double>(problem.configurations.size()) * problem.folds;
  double done = 0.0;
  for (const auto& entry : problem.configurations) {
    const std::string& name = entry.first;
    const TrainingConfig& config = entry.second;
    const std::size_t first = result.rows.size();
    for (int fold = 0; fold < problem.folds; ++fold) {
      const HoldOut hold_out{fold, problem.folds};
      const Dataset training = selectFold(dataset, hold_out, false);
      const Dataset test = selectFold(dataset, hold_out, true);
      TrainingResult last;
      const auto report = [&](double fraction) {
        if (progress)
          progress(format("%s, fold %d/%d", name.c_str(), fold, problem.folds),
                   (done + fraction) / parts);
      };
      append(rowsOf({training, test, name, config, problem.gates, fold, problem.observer}, report,
                    last),
             result.rows);
      done += 1.0;
    }
    const std::size_t per_fold = (result.rows.size() - first) / problem.folds;
    for (std::size_t k = 0; k < per_fold; ++k) {
      std::vector<TableOneRow> folds;
      for (int fold = 0; fold < problem.folds; ++fold)
        folds.push_back(result.rows[first + static_cast<std::size_t>(fold) * per_fold + k]);
      result.rows.push_back(meanRow(folds));
    }
    describeData(dataset, config, result);
  }
  return result;
}

TableOneResult evaluateOn(const Dataset& training, const Dataset& test,
                          const TableOneProblem& problem, const Progress& progress) {
  TableOneResult result;
  double done = 0.0;
  for (const auto& entry : problem.configurations) {
    const std::string& name = entry.first;
    const TrainingConfig& config = entry.second;
    TrainingResult last;
    const auto report = [&](double fraction) {
      if (progress)
        progress(name, (done + fraction) / static_cast<double>(problem.configurations.size()));
    };
    append(rowsOf({training, test, name, config, problem.gates, kMeanOfFolds, problem.observer},
                  report, last),
           result.rows);
    done += 1.0;
    describeData(training, config, result);
  }
  return result;
}

}  // namespace raven_correction
