// SPDX-License-Identifier: BSD-3-Clause
// Which pairs are worth learning from: physical limits, least median of squares, and trajectories
// that are rejected whole. Every rejection keeps its reason. Samples that cannot be real, and
// pairing, are dataset/synchronisation.h.
#pragma once

#include <cstdint>
#include <vector>

#include "raven_correction/dataset/synchronisation.h"
#include "raven_correction/geometry/pose.h"

namespace raven_correction {

/// One synchronised pair with what the limits look at.
struct CleaningSample {
  std::size_t trajectory = 0;  ///< index; samples of one trajectory are neighbours
  Pose observation;            ///< in base
  Pose command;                ///< in base
  Twist twist;                 ///< of the observation
  double step = 0.0;           ///< since the observation before it [s]; 0 for the first of a motion
};

/// Limits that a real tool keeps. A limit of 0 is not checked.
struct PhysicalLimits {
  /// Largest angle from the mean observed orientation: beyond it the markers face away from the
  /// cameras. The mean is robust: over the samples that lie within it, repeated until it rests.
  /// [rad]
  double rotation_window = 1.0472;
  /// Observations may lie this far outside the box of the commands. [m]
  double workspace_margin = 0.06;
  double speed = 0.4;          ///< [m/s]
  double angular_speed = 6.0;  ///< [rad/s]
  double step = 0.15;          ///< longest interval to the sample before [s]
};

struct CleaningOptions {
  PhysicalLimits limits;
  /// Pairs whose residual exceeds this many robust standard deviations of the least-median model
  /// are rejected; 0: least median of squares is not used. [-]
  double least_median_threshold = 4.0;
  double rotation_length = 0.05;  ///< of the residual, see least_median.h [m]
  double trajectory_share = 0.9;  ///< a trajectory with a larger share rejected goes whole [-]
  std::uint64_t seed = 1;
};

struct CleaningResult {
  enum class Status { kNotRun, kOk, kNothingLeft };
  Status status = Status::kNotRun;
  std::vector<Fate> fates;          ///< one per sample
  FateCounts counts;                ///< their sum
  double least_median_scale = 0.0;  ///< robust standard deviation of the rigid residual [m]
  Eigen::Quaterniond mean_orientation = Eigen::Quaterniond::Identity();  ///< of the rotation window
};

/// Limits first, then least median of squares on what is left, then whole trajectories.
/// @throws InvalidInput  an option is negative or not finite, or trajectory_share is outside (0, 1]
/// Source: Mahler et al. 2014, section IV-A (limits, LMedS, P = 90 %)
CleaningResult clean(const std::vector<CleaningSample>& samples, const CleaningOptions& options);

}  // namespace raven_correction
