// SPDX-License-Identifier: BSD-3-Clause
#include "raven_correction/geometry/stream.h"

#include <algorithm>

#include "raven_correction/geometry/statistics.h"

namespace raven_correction {

std::optional<Pose> poseAt(const PoseStream& stream, double instant, double max_gap) noexcept {
  const auto later = [](double t, const StampedPose& s) { return t < s.stamp; };
  const auto after = std::upper_bound(stream.begin(), stream.end(), instant, later);
  if (after == stream.begin()) return std::nullopt;  // before the first sample, or no sample
  const StampedPose& a = *(after - 1);
  if (a.stamp == instant) return a.pose;
  if (after == stream.end()) return std::nullopt;
  const double gap = after->stamp - a.stamp;
  if (!(gap <= max_gap)) return std::nullopt;
  return interpolate(a.pose, after->pose, (instant - a.stamp) / gap);
}

double medianPeriod(const PoseStream& stream) {
  std::vector<double> periods;
  for (std::size_t i = 1; i < stream.size(); ++i) {
    const double period = stream[i].stamp - stream[i - 1].stamp;
    if (period > 0.0) periods.push_back(period);
  }
  return periods.empty() ? 0.0 : median(std::move(periods));
}

}  // namespace raven_correction
