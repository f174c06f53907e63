// SPDX-License-Identifier: BSD-3-Clause
// Table I of the paper on trajectories not used in training: six methods, from no correction to
// everything, each on a dirty and a clean test set. Error measures are error_metrics.h.
// Source: Mahler et al. 2014, section V-B, Table I
#pragma once

#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "raven_correction/correction/training.h"
#include "raven_correction/evaluation/error_metrics.h"
#include "raven_correction/evaluation/test_states.h"

namespace raven_correction {

enum class Method {
  kNone,                  ///< the command as the planner gave it
  kRigid,                 ///< rigid transform from all pairs
  kRigidClean,            ///< rigid transform from cleaned pairs
  kRigidGp,               ///< + Gaussian process on poses, all pairs
  kRigidGpVelocity,       ///< + velocity features
  kRigidGpVelocityClean,  ///< + cleaning: the configuration as it is
  kCount
};
/// "none", "rigid", "rigid_clean", "rigid_gp", "rigid_gp_velocity", "rigid_gp_velocity_clean".
const char* methodName(Method method) noexcept;

/// The configuration with what the method does not have switched off. No method has physics as its
/// mean: a simulation knows the trajectories that it was diagnosed from, so folds that test on them
/// would flatter it. learning_curve.h compares with physics, with a simulation for each fold.
TrainingConfig configOf(Method method, const TrainingConfig& config);

constexpr int kMeanOfFolds = -1;

struct TableOneRow {
  std::string configuration;
  Method method = Method::kNone;
  bool clean = false;  ///< test set
  int fold = kMeanOfFolds;
  ErrorSummary errors;      ///< n is the number of test states
  std::size_t n_train = 0;  ///< pairs learnt from; over folds: the mean
};

/// Called with every row as it is made, its errors one by one and the states they belong to; both
/// lists are in the same order. Lets others judge a table, e.g. by intervals over trajectories.
using TableOneObserver = std::function<void(const TableOneRow& row, const std::vector<TestState>&,
                                            const std::vector<PoseError>&)>;

struct TableOneProblem {
  /// Name ("paper", "best") and configuration, one table each. The name is what rows carry.
  std::vector<std::pair<std::string, TrainingConfig>> configurations;
  int folds = 5;
  CleanGates gates;
  TableOneObserver observer;  ///< may be empty
};

struct TableOneResult {
  std::vector<TableOneRow> rows;  ///< per configuration: per fold, then the mean
  /// Of the last configuration (the package's own), from all data.
  double delay = 0.0;  ///< [s]
  FateCounts fates;    ///< cleaning of all observations
  std::size_t identity_commands = 0;

  /// @throws InvalidInput  no such row
  const TableOneRow& row(const std::string& configuration, Method method, bool clean,
                         int fold) const;
};

/// Trajectory i (zero-based, by start time) tests in fold i % folds.
/// @throws InvalidInput  fewer trajectories than folds, or see train()
TableOneResult crossValidate(const Dataset& dataset, const TableOneProblem& problem,
                             const Progress& progress = {});

/// The same with a test set of its own instead of folds: rows have fold kMeanOfFolds.
TableOneResult evaluateOn(const Dataset& training, const Dataset& test,
                          const TableOneProblem& problem, const Progress& progress = {});

}  // namespace raven_correction
