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

void sortByStart(Dataset& dataset) {
  std::stable_sort(dataset.trajectories.begin(), dataset.trajectories.end(),
                   [](const Trajectory& a, const Trajectory& b) { return a.start() < b.start(); });
}

}  // namespace raven_correction
