// SPDX-License-Identifier: BSD-3-Clause
#include "raven_correction/dataset/stream_health.h"

#include <algorithm>

#include "raven_correction/geometry/statistics.h"

namespace raven_correction {
namespace {

constexpr double kGap = 3.0;  // intervals longer than so many medians are gaps [-]

bool isFiniteSample(const StampedPose& sample) { return isFinite(sample.pose); }
bool isFiniteSample(const StampedJoints& sample) { return sample.positions.allFinite(); }
bool isSame(const StampedPose& a, const StampedPose& b) {
  return a.pose.p == b.pose.p && a.pose.q.coeffs() == b.pose.q.coeffs();
}
bool isSame(const StampedJoints& a, const StampedJoints& b) { return a.positions == b.positions; }

/// Collects one stream, trajectory by trajectory.
class Collector {
 public:
  Collector(const char* stream, bool repeats_count) : repeats_count_(repeats_count) {
    health_.stream = stream;
  }

  template <typename Samples>
  void add(const std::string& trajectory, const Samples& samples) {
    if (samples.empty()) return;
    ++health_.trajectories;
    health_.samples += samples.size();
    health_.duration += samples.back().stamp - samples.front().stamp;
    for (std::size_t i = 0; i < samples.size(); ++i) {
      if (!isFiniteSample(samples[i])) ++health_.not_finite;
      if (i == 0) continue;
      const double interval = samples[i].stamp - samples[i - 1].stamp;
      // A robot at rest is sent the same command again; a tracker never sees the same pose twice.
      if (!(interval > 0.0) || (repeats_count_ && isSame(samples[i], samples[i - 1])))
        ++health_.repeated;
      if (!(interval > 0.0)) continue;
      intervals_.push_back(interval);
      if (interval <= health_.longest_gap) continue;
      health_.longest_gap = interval;
      health_.longest_in = trajectory;
    }
  }

  StreamHealth finish() {
    if (intervals_.empty()) return health_;
    health_.period_median = median(intervals_);
    health_.period_p95 = quantile(intervals_, 0.95);
    double in_gaps = 0.0, all = 0.0;
    for (const double interval : intervals_) {
      all += interval;
      if (interval > kGap * health_.period_median) in_gaps += interval;
    }
    health_.gap_share = in_gaps / all;
    return health_;
  }

 private:
  const bool repeats_count_;
  StreamHealth health_;
  std::vector<double> intervals_;
};

}  // namespace

std::vector<StreamHealth> streamHealth(const Dataset& dataset) {
  Collector commands("commands", false), observations("observations", true);
  Collector encoders("encoders", false), joint_commands("joint commands", false);
  Collector joint_observations("joint observations", false);
  for (const Trajectory& trajectory : dataset.trajectories) {
    commands.add(trajectory.id, trajectory.commands);
    observations.add(trajectory.id, trajectory.observations);
    encoders.add(trajectory.id, trajectory.encoders);
    joint_commands.add(trajectory.id, trajectory.joint_commands.samples);
    joint_observations.add(trajectory.id, trajectory.joint_observations.samples);
  }
  std::vector<StreamHealth> all;
  for (Collector* const collector :
       {&commands, &observations, &encoders, &joint_commands, &joint_observations}) {
    all.push_back(collector->finish());
    if (all.back().samples == 0) all.pop_back();
  }
  return all;
}

}  // namespace raven_correction
