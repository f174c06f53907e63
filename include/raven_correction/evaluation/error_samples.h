// SPDX-License-Identifier: BSD-3-Clause
// The errors behind Table I one by one, for figures and for judging the predicted intervals. What
// they come to is error_metrics.h; the table itself is table_one.h.
#pragma once

#include <string>
#include <vector>

#include "raven_correction/evaluation/table_one.h"

namespace raven_correction {

/// All errors of one configuration and method on one test set, folds one after the other.
struct ErrorSeries {
  std::string configuration;
  Method method = Method::kNone;
  bool clean = false;
  std::vector<Eigen::Matrix<double, 6, 1>> components;  ///< see PoseError [m, rad]
  std::vector<double> position;                         ///< length of the position error [m]
  std::vector<double> angle;                            ///< of the orientation error [rad]
  /// PoseError::residual over PoseError::deviation; empty where nothing was predicted [-].
  std::vector<Eigen::Matrix<double, 6, 1>> standardised;
};

/// Collects what crossValidate() and evaluateOn() tell their observer.
class ErrorSamples {
 public:
  /// Refers to this object, which has to outlive the run.
  TableOneObserver observer();
  const std::vector<ErrorSeries>& series() const noexcept { return series_; }
  /// @throws InvalidInput  no such series
  const ErrorSeries& find(const std::string& configuration, Method method, bool clean) const;

 private:
  std::vector<ErrorSeries> series_;
};

/// Which share of the true values lies inside predicted intervals of many widths.
struct CoverageCurve {
  std::vector<double> nominal;  ///< probability that an interval claims [-]
  Eigen::MatrixXd observed;     ///< a row per probability, six columns: dx dy dz rx ry rz [-]
};
/// Intervals are central and normal. Empty where nothing was predicted.
/// @param standardised  true minus predicted, over the predicted deviation
CoverageCurve coverageOf(const std::vector<Eigen::Matrix<double, 6, 1>>& standardised);

/// One method's errors as a series of their own, without the names.
void append(const std::vector<PoseError>& errors, ErrorSeries& series);

}  // namespace raven_correction
