// SPDX-License-Identifier: BSD-3-Clause
// Adding rows to a trained process and dropping them again.
#include "raven_correction/regression/online_process.h"

#include <algorithm>

#include "raven_correction/error.h"

namespace raven_correction {
OnlineProcess::OnlineProcess(const GpModel& model, const Eigen::MatrixXd& features,
                             const Eigen::MatrixXd& targets, GpBackend backend)
    : features_(model.features), outputs_(model.outputs) {
  check(features, targets);
  const Eigen::MatrixXd points = features.transpose();
  for (const GpGroup& group : model.groups) {
    const Eigen::MatrixXd group_targets = groupTargets(group, targets);
    if (backend == GpBackend::kExact) {
      groups_.emplace_back(ExactStatistics(group, points, group_targets));
    } else {
      SparseStatistics statistics(group, group.points);
      statistics.update(points, group_targets, 1.0);
      groups_.emplace_back(std::move(statistics));
    }
    variance_points_.push_back(group.variance_factor.rows());
  }
  remember(features, targets);
}

void OnlineProcess::check(const Eigen::MatrixXd& features, const Eigen::MatrixXd& targets) const {
  if (features.cols() != features_ || targets.cols() != outputs_ ||
      features.rows() != targets.rows())
    throw InvalidInput(format(
        "%td x %td features and %td x %td targets do not fit a model of %d "
        "features and %d outputs",
        features.rows(), features.cols(), targets.rows(), targets.cols(), features_, outputs_));
  for (Eigen::Index i = 0; i < features.rows(); ++i)
    if (!features.row(i).allFinite() || !targets.row(i).allFinite())
      throw InvalidInput(
          format("row %td (from 0) holds a value that is not finite; leave it out", i));
}

void OnlineProcess::remember(const Eigen::MatrixXd& features, const Eigen::MatrixXd& targets) {
  for (Eigen::Index i = 0; i < features.rows(); ++i)
    rows_.push_back({features.row(i).transpose(), targets.row(i).transpose()});
}

void OnlineProcess::add(const Eigen::MatrixXd& features, const Eigen::MatrixXd& targets) {
  check(features, targets);
  const Eigen::MatrixXd points = features.transpose();
  for (auto& group : groups_) {
    if (auto* const exact = std::get_if<ExactStatistics>(&group))
      exact->append(points, groupTargets(exact->group(), targets));
    else if (auto* const sparse = std::get_if<SparseStatistics>(&group))
      sparse->update(points, groupTargets(sparse->group(), targets), 1.0);
  }
  remember(features, targets);
}

void OnlineProcess::dropOldest(Eigen::Index count) {
  if (count < 0 || count > rows())
    throw InvalidInput(format("%td oldest rows to drop, but there are %td", count, rows()));
  Eigen::MatrixXd points(features_, count);
  Eigen::MatrixXd targets(count, outputs_);
  for (Eigen::Index i = 0; i < count; ++i) {
    points.col(i) = rows_[std::size_t(i)].features;
    targets.row(i) = rows_[std::size_t(i)].targets.transpose();
  }
  for (auto& group : groups_) {
    if (auto* const exact = std::get_if<ExactStatistics>(&group))
      exact->dropOldest(count);
    else if (auto* const sparse = std::get_if<SparseStatistics>(&group))
      sparse->update(points, groupTargets(sparse->group(), targets), -1.0);
  }
  rows_.erase(rows_.begin(), rows_.begin() + count);
}

GpModel OnlineProcess::model() const {
  GpModel model;
  model.features = features_;
  model.outputs = outputs_;
  for (std::size_t g = 0; g < groups_.size(); ++g)
    model.groups.push_back(std::visit(
        [&](const auto& group) { return group.posterior(variance_points_[g]); }, groups_[g]));
  return model;
}

}  // namespace raven_correction
