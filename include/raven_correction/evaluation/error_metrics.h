// SPDX-License-Identifier: BSD-3-Clause
// How far a predicted pose is from the true one, and what a list of such errors comes to. Which
// poses are compared is test_states.h.
#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "raven_correction/geometry/pose.h"

namespace raven_correction {

struct PoseError {
  /// p_true - p_predicted in the base frame [m], then yaw, pitch, roll (ZYX) of
  /// inv(R_predicted) R_true [rad].
  Eigen::Matrix<double, 6, 1> components = Eigen::Matrix<double, 6, 1>::Zero();
  /// Translation of inv(predicted) true: the measure of Mahler et al. 2014 [m].
  Eigen::Vector3d position_in_tool = Eigen::Vector3d::Zero();
  double angle = 0.0;  ///< of inv(R_predicted) R_true, in [0, pi] [rad]
  /// Of the six outputs of the process (dp, r; model.h): true minus predicted, and the standard
  /// deviation that was predicted for it [m, rad]. Zero deviation: nothing was.
  Eigen::Matrix<double, 6, 1> residual = Eigen::Matrix<double, 6, 1>::Zero();
  Eigen::Matrix<double, 6, 1> deviation = Eigen::Matrix<double, 6, 1>::Zero();
};
PoseError poseError(const Pose& predicted, const Pose& truth);

/// Metres and radians throughout.
struct ErrorSummary {
  std::size_t n = 0;
  Eigen::Matrix<double, 6, 1> mean_abs = Eigen::Matrix<double, 6, 1>::Zero();  ///< tx..roll
  Eigen::Matrix<double, 6, 1> std =
      Eigen::Matrix<double, 6, 1>::Zero();  ///< of the absolute errors
  double position_norm = 0.0;               ///< of the three mean absolute errors [m]
  double angle_norm = 0.0;                  ///< of the three mean absolute angles [rad]
  double position_median = 0.0;             ///< of the Euclidean errors [m]
  double position_p95 = 0.0;                ///< of the Euclidean errors [m]
  double position_norm_paper = 0.0;  ///< norm of the mean absolute errors in the tool frame [m]
  double angle_mean = 0.0;           ///< of the rotation angles [rad]
  /// Of the outputs of the process (PoseError::residual); NaN where no deviations were predicted.
  Eigen::Matrix<double, 6, 1> coverage95;  ///< share inside +- 1.96 deviations [-]
  Eigen::Matrix<double, 6, 1> nlpd;        ///< mean negative log predictive density [nat; m, rad]
  ErrorSummary();
};
/// All zero, n = 0, for an empty list.
ErrorSummary summarise(const std::vector<PoseError>& errors);

/// Field by field mean, n the sum: a table over folds from its folds.
ErrorSummary meanOf(const std::vector<ErrorSummary>& summaries);

}  // namespace raven_correction
