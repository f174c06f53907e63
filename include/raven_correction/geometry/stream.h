// SPDX-License-Identifier: BSD-3-Clause
// Time-stamped sequences of poses and of joint vectors, and what one knows between the samples.
// How a velocity is taken from such a sequence is in differentiation.h.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "raven_correction/geometry/pose.h"

namespace raven_correction {

struct StampedPose {
  double stamp = 0.0;  ///< when it was measured or meant [s]
  Pose pose;           ///< frame as said by the owner of the stream
};
/// Stamps never decrease; equal stamps may follow one another (a repeated frame).
using PoseStream = std::vector<StampedPose>;

struct StampedJoints {
  double stamp = 0.0;         ///< [s]
  Eigen::VectorXd positions;  ///< one per joint name of the stream [rad or m]
};
struct JointStream {
  std::vector<std::string> names;
  std::vector<StampedJoints> samples;  ///< stamps never decrease
};

/// Pose at an instant between two samples, by interpolate() of pose.h; exact at a sample.
/// Nothing before the first or after the last sample, and nothing inside an interval longer than
/// max_gap.
/// @param stream   sorted by stamp
/// @param instant  [s]
/// @param max_gap  longest interval that may be bridged, > 0 [s]
std::optional<Pose> poseAt(const PoseStream& stream, double instant, double max_gap) noexcept;

/// Median interval between successive different stamps [s]; 0 for fewer than two of them.
double medianPeriod(const PoseStream& stream);

}  // namespace raven_correction
