// SPDX-License-Identifier: BSD-3-Clause
// Replanning with the measured tool pose: how far the tool is from what was commanded a moment ago,
// and the command that undoes it from now on. It learns nothing: what was measured here is applied
// there.
#pragma once

#include <Eigen/Core>

#include "raven_correction/geometry/stream.h"

namespace raven_correction {

struct ReplanConfig {
  double delay = 0.0;       ///< of the tool behind its commands, as far as the planner knows [s]
  double blend = 0.4;       ///< in which a new measurement takes effect, > 0 [s]
  std::size_t samples = 5;  ///< that a measurement needs at least
  /// A measurement that differs from the one before by more is taken for a fault of motion capture,
  /// unless the next ones say the same.
  double jump = 0.015;          ///< [m]
  double jump_angle = 0.5;      ///< [rad]
  unsigned jumps_believed = 3;  ///< so many of them in a row are believed
  /// The tool is corrected already, so that nothing is what the first measurement is expected to
  /// say: a large deviation is a fault then, too.
  bool corrected = false;
};

/// Deviation D = (d, r) of a measured pose m from its command c: p_m = p_c + d, R_m = R_c exp(r).
/// Not thread-safe.
class DeviationReplanner {
 public:
  /// @throws InvalidInput  a value out of its range
  explicit DeviationReplanner(const ReplanConfig& config);

  /// The command with which the tool comes to `desired`, if it deviates as measured last:
  ///   p_c = p - d(t), R_c = R exp(-r(t)),
  /// where D(t) goes linearly from one measurement to the next.
  /// @param time  [s]
  Pose command(const Pose& desired, double time) const noexcept;
  /// Takes the median deviation over the observations.
  /// @param commands  that were sent, by stamp
  /// @param observed  tool poses of the last moments, in the same frame
  /// @param time      from which on it takes effect [s]
  /// @return false: too few of them fall between the commands, or it is taken for a fault
  bool measure(const PoseStream& commands, const PoseStream& observed, double time);
  /// No deviation from `time` on, blended like a measurement.
  void forget(double time) noexcept;
  const Eigen::Vector3d& translation() const noexcept { return to_.d; }  ///< measured last [m]
  const Eigen::Vector3d& rotation() const noexcept { return to_.r; }     ///< likewise [rad]
  unsigned measurements() const noexcept { return measurements_; }

 private:
  struct Deviation {
    Eigen::Vector3d d = Eigen::Vector3d::Zero();
    Eigen::Vector3d r = Eigen::Vector3d::Zero();
  };
  Deviation at(double time) const noexcept;

  ReplanConfig config_;
  Deviation from_, to_;
  double since_ = 0.0;  // from_ turns into to_ from here on [s]
  unsigned measurements_ = 0;
  unsigned jumps_ = 0;  // in a row
};

}  // namespace raven_correction
