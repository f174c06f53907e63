// SPDX-License-Identifier: BSD-3-Clause
#include "raven_correction/dataset/trajectory.h"

#include <algorithm>

namespace raven_correction {

double Trajectory::start() const noexcept {
  for (const PoseStream* stream : {&commands, &observations, &encoders})
    if (!stream->empty()) return stream->front().stamp;
  for (const JointStream* stream : {&joint_commands, &joint_observations})
    if (!stream->samples.empty()) return stream->samples.front().stamp;
  return 0.0;
}

double Trajectory::end() const noexcept {
  bool any = false;
  double last = 0.0;
  const auto reach = [&](double stamp) {
    last = any ? std::max(last, stamp) : stamp;
    any = true;
  };
  for (const PoseStream* stream : {&commands, &observations, &encoders})
    if (!stream->empty()) reach(stream->back().stamp);
  for (const JointStream* stream : {&joint_commands, &joint_observations})
    if (!stream->samples.empty()) reach(stream->samples.back().stamp);
  return last;
}

std::vector<std::size_t> sessionStarts(const Dataset& dataset) {
  std::vector<std::size_t> starts;
  double last = 0.0;
  for (std::size_t i = 0; i < dataset.trajectories.size(); ++i) {
    const Trajectory& trajectory = dataset.trajectories[i];
    if (starts.empty() || trajectory.start() - last > kLongestPause) {
      starts.push_back(i);
      last = trajectory.end();
    } else {
      last = std::max(last, trajectory.end());
    }
  }
  return starts;
}

void sortByStart(Dataset& dataset) {
  std::stable_sort(dataset.trajectories.begin(), dataset.trajectories.end(),
                   [](const Trajectory& a, const Trajectory& b) { return a.start() < b.start(); });
}

}  // namespace raven_correction
