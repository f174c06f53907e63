// SPDX-License-Identifier: BSD-3-Clause
// Adding rows to a trained process and dropping them again.
#include "raven_correction/regression/online_process.h"

#include <algorithm>

#include "raven_correction/error.h"

namespace raven_correction {
OnlineProcess::OnlineProcess(const GpModel& model, const Eigen::MatrixXd& features,
                             const Eigen::MatrixXd& targets)
    : features_(model.features), outputs_(model.outputs) {
  for (const GpGroup& group : model.groups) {
    groups_.emplace_back(group, group.points);
    variance_points_.push_back(group.variance_factor.rows());
  }
  add(features, targets);
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

void OnlineProcess::update(const Eigen::MatrixXd& features, const Eigen::MatrixXd& targets,
                           double sign) {
  const Eigen::MatrixXd points = features.transpose();
  for (SparseStatistics& group : groups_)
    group.update(points, groupTargets(group.group(), targets), sign);
}

void OnlineProcess::add(const Eigen::MatrixXd& features, const Eigen::MatrixXd& targets) {
  check(features, targets);
  update(features, targets, 1.0);
  for (Eigen::Index i = 0; i < features.rows(); ++i)
    rows_.push_back({features.row(i).transpose(), targets.row(i).transpose()});
}

void OnlineProcess::dropOldest(Eigen::Index count) {
  if (count < 0 || count > rows())
    throw InvalidInput(format("%td oldest rows to drop, but there are %td", count, rows()));
  Eigen::MatrixXd features(count, features_);
  Eigen::MatrixXd targets(count, outputs_);
  for (Eigen::Index i = 0; i < count; ++i) {
    features.row(i) = rows_[std::size_t(i)].features.transpose();
    targets.row(i) = rows_[std::size_t(i)].targets.transpose();
  }
  update(features, targets, -1.0);
  rows_.erase(rows_.begin(), rows_.begin() + count);
}

GpModel OnlineProcess::model() const {
  GpModel model;
  model.features = features_;
  model.outputs = outputs_;
  for (std::size_t g = 0; g < groups_.size(); ++g)
    model.groups.push_back(groups_[g].posterior(variance_points_[g]));
  return model;
}

}  // namespace raven_correction
