// SPDX-License-Identifier: BSD-3-Clause
// Table II of the paper: the same poses visited again and again. How far from them the tool comes
// to rest, and how much one visit of a pose differs from the next. One visit is visits.h.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <vector>

#include "raven_correction/evaluation/visits.h"

namespace raven_correction {

/// In which order `poses` poses are visited `rounds` times each: every round visits all of them, in
/// an order of its own, and never the same pose twice in a row (unless there is but one), so that a
/// pose is approached from another side each time.
/// @return poses * rounds indices
/// @throws InvalidInput  poses or rounds is 0
std::vector<std::size_t> visitOrder(std::size_t poses, std::size_t rounds, std::uint64_t seed);

/// Metres and radians; components as in PoseError.
struct RepeatabilityResult {
  std::size_t poses = 0;   ///< seen at least once
  std::size_t visits = 0;  ///< seen at rest
  ErrorSummary errors;     ///< over all visits
  /// Scatter of the visits of one pose about their own mean, pooled over poses: the repeatability.
  ///   sqrt( sum_j sum_k (e_jk - mean_j)^2 / sum_j (n_j - 1) ); 0 where no pose was seen twice
  Eigen::Matrix<double, 6, 1> repeatability = Eigen::Matrix<double, 6, 1>::Zero();
  /// What averaging over visits leaves: root mean square over poses of their mean errors.
  Eigen::Matrix<double, 6, 1> mean_error = Eigen::Matrix<double, 6, 1>::Zero();
  std::vector<std::string> unseen;  ///< names of visits that nobody saw at rest
};

/// @param visits  of all poses, in any order
/// @param pose    index of the pose of each visit
/// @throws InvalidInput  not one pose per visit, or no visit was seen at rest
RepeatabilityResult repeatability(const std::vector<Visit>& visits,
                                  const std::vector<std::size_t>& pose);

}  // namespace raven_correction
