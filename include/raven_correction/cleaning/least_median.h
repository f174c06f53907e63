// SPDX-License-Identifier: BSD-3-Clause
// Least median of squares over rigid models: the rigid transform that suits the better half of the
// pairs, however wrong the others are. The least-squares fit is geometry/rigid_fit.h.
#pragma once

#include <cstdint>
#include <vector>

#include "raven_correction/geometry/pose.h"

namespace raven_correction {

struct LeastMedianProblem {
  std::vector<Pose> from;         ///< observed poses, N
  std::vector<Pose> to;           ///< commands, N
  double rotation_length = 0.05;  ///< converts radians into metres in the residual, > 0 [m]
  int candidates = 500;           ///< random models tried, each from `subset` pairs
  int subset = 3;                 ///< pairs per model; one determines it, more calm its noise
  std::size_t max_scored = 5000;  ///< pairs the median is taken over (evenly spread)
  std::uint64_t seed = 1;
};

struct LeastMedianResult {
  enum class Status { kNotRun, kOk, kTooFewPairs };
  Status status = Status::kNotRun;
  Pose X_to_from;                 ///< to ~ X_to_from * from
  double scale = 0.0;             ///< robust standard deviation of the residual [m]
  std::vector<double> residuals;  ///< of all N pairs [m]
};

/// Residual of one pair, with e the position error and a the angle of inv(X from) to:
///
///   r = sqrt( |e|^2 + (L a)^2 )                                      [m], L the rotation length
///
/// Of the candidates, the one with the smallest median of r^2 wins; it is refined by least squares
/// on the half it explains best for as long as that lowers the median. The scale is
/// 1.4826 (1 + 5 / (n - 6)) sqrt(median r^2).
/// @throws InvalidInput  sizes differ, or a parameter is out of its range
/// Source: Rousseeuw 1984, doi:10.1080/01621459.1984.10477105; Mahler et al. 2014, section IV-A
LeastMedianResult fitLeastMedian(const LeastMedianProblem& problem);

}  // namespace raven_correction
