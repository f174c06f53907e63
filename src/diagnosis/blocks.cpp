// SPDX-License-Identifier: BSD-3-Clause
#include "raven_correction/diagnosis/blocks.h"

#include <algorithm>
#include <utility>

#include "raven_correction/error.h"

namespace raven_correction {
namespace {

using Motion = Recording::Motion;

// Of the set-points of the block before: the one in force, and the one ahead that linear set-points
// are on their way to.
constexpr std::size_t kCarried = 2;

/// Observations and frames of every block of time, without set-points.
std::vector<Motion> windowsOf(const Motion& motion, int blocks) {
  const double start = motion.setpoints.front().stamp;
  const double end = std::max(motion.setpoints.back().stamp, motion.observations.back().stamp);
  const double length = (end - start) / blocks;
  std::vector<Motion> windows(static_cast<std::size_t>(blocks));
  const auto window = [&](double stamp) -> Motion& {
    const int i = length > 0.0 ? static_cast<int>((stamp - start) / length) : 0;
    return windows[static_cast<std::size_t>(std::clamp(i, 0, blocks - 1))];
  };
  for (const Recording::Observation& observation : motion.observations)
    window(observation.stamp).observations.push_back(observation);
  for (const Recording::Observation& frame : motion.frames)
    window(frame.stamp).frames.push_back(frame);
  return windows;
}

/// The windows that have something to see, with the set-points that they need.
void addBlocks(const Motion& motion, int blocks, std::vector<Motion>& cut) {
  const std::vector<Recording::Setpoint>& setpoints = motion.setpoints;
  std::vector<Motion> windows = windowsOf(motion, blocks);
  const std::size_t first = cut.size();
  std::size_t taken = 0;                          // set-points that the blocks so far have had
  std::vector<Recording::Observation> unclaimed;  // frames of windows without observations
  for (std::size_t i = 0; i < windows.size(); ++i) {
    Motion& block = windows[i];
    block.frames.insert(block.frames.begin(), unclaimed.begin(), unclaimed.end());
    unclaimed.clear();
    if (block.observations.empty()) {
      unclaimed = std::move(block.frames);
      continue;
    }
    block.id = format("%s block %zu", motion.id.c_str(), i);
    // As the arm takes them: up to one beyond what is seen last.
    double last = block.observations.back().stamp;
    if (!block.frames.empty()) last = std::max(last, block.frames.back().stamp);
    const auto beyond = std::upper_bound(
        setpoints.begin(), setpoints.end(), last,
        [](double stamp, const Recording::Setpoint& setpoint) { return stamp < setpoint.stamp; });
    const auto end = std::max(setpoints.begin() + static_cast<std::ptrdiff_t>(taken),
                              beyond == setpoints.end() ? beyond : beyond + 1);
    block.carried = std::min(taken, kCarried);
    block.setpoints.assign(setpoints.begin() + static_cast<std::ptrdiff_t>(taken - block.carried),
                           end);
    taken = static_cast<std::size_t>(end - setpoints.begin());
    cut.push_back(std::move(block));
  }
  Motion& last = cut.back();
  last.setpoints.insert(last.setpoints.end(),
                        setpoints.begin() + static_cast<std::ptrdiff_t>(taken), setpoints.end());
  last.frames.insert(last.frames.end(), unclaimed.begin(), unclaimed.end());
  cut[first].carried = motion.carried;
}

}  // namespace

void cutIntoBlocks(int least, Recording& recording) {
  const int motions = static_cast<int>(recording.motions.size());
  if (motions == 0 || motions >= least) return;
  const int blocks = (least + motions - 1) / motions;
  std::vector<Motion> cut;
  for (const Motion& motion : recording.motions) addBlocks(motion, blocks, cut);
  recording.motions = std::move(cut);
}

}  // namespace raven_correction
