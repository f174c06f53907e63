// SPDX-License-Identifier: BSD-3-Clause
#include "raven_correction/ros/overlay_history.h"

#include <algorithm>

namespace raven_correction {
namespace {

constexpr double kTrailPeriod = 0.02;       // between two samples of a trail [s]
constexpr double kStatusAge = 0.5;          // an older status says nothing [s]
constexpr double kDesiredSilence = 1.0;     // then the command is what is wanted [s]
constexpr std::size_t kStatuses = 10000;    // ten seconds at 1 kHz
constexpr std::size_t kMeanSamples = 5000;  // ten seconds at 480 Hz
constexpr double kJumpBack = 1.0;           // of a stamp: the recording starts again [s]

}  // namespace

OverlayHistory::OverlayHistory(const OverlayHistoryOptions& options)
    : options_(options), against_desired_({}), against_command_({}) {}

void OverlayHistory::clear() {
  against_desired_.clear();
  against_command_.clear();
  desired_.clear();
  command_.clear();
  observed_.clear();
  statuses_.clear();
  latest_.reset();
  errors_.clear();
  sums_[0] = sums_[1] = {};
}

void OverlayHistory::extend(std::deque<StampedPose>& trail, const StampedPose& sample) const {
  if (!isFinite(sample.pose) || !hasUnitQuaternion(sample.pose) || !(sample.stamp > 0.0)) return;
  if (!trail.empty() && sample.stamp < trail.back().stamp - kJumpBack) trail.clear();
  // The newest sample gives way to the next one until it is a period behind the one before it.
  const std::size_t n = trail.size();
  if (n >= 2 && trail[n - 1].stamp - trail[n - 2].stamp < kTrailPeriod) trail.pop_back();
  trail.push_back(sample);
  while (trail.front().stamp < sample.stamp - options_.trail_duration) trail.pop_front();
}

std::optional<Pose> OverlayHistory::commandAt(double instant) const {
  return poseAt(PoseStream(command_.begin(), command_.end()), instant, kDesiredSilence);
}

void OverlayHistory::addDesired(const StampedPose& desired) {
  extend(desired_, desired);
  take(against_desired_.addCommand(desired));
}

void OverlayHistory::addCommand(const StampedPose& command) {
  extend(command_, command);
  const std::vector<LivePair> pairs = against_command_.addCommand(command);
  const bool planner_speaks =
      !desired_.empty() && command.stamp - desired_.back().stamp < kDesiredSilence;
  if (!planner_speaks) take(pairs);
}

void OverlayHistory::addObserved(const StampedPose& observed) {
  extend(observed_, observed);
  const StampedPose meant{observed.stamp - options_.delay, observed.pose};
  take(against_desired_.addObservation(meant));
  const std::vector<LivePair> pairs = against_command_.addObservation(meant);
  const bool planner_speaks =
      !desired_.empty() && meant.stamp - desired_.back().stamp < kDesiredSilence;
  if (!planner_speaks) take(pairs);
}

void OverlayHistory::addStatus(double stamp, bool corrected) {
  if (!statuses_.empty() && stamp < statuses_.back().stamp) statuses_.clear();
  statuses_.push_back({stamp, corrected});
  if (statuses_.size() > kStatuses) statuses_.pop_front();
}

bool OverlayHistory::wasCorrected(double stamp) const {
  const auto later = [](double t, const Status& s) { return t < s.stamp; };
  const auto after = std::upper_bound(statuses_.begin(), statuses_.end(), stamp, later);
  if (after == statuses_.begin()) return false;
  const Status& status = *(after - 1);
  return stamp - status.stamp < kStatusAge && status.corrected;
}

void OverlayHistory::take(const std::vector<LivePair>& pairs) {
  for (const LivePair& pair : pairs) {
    TrackingError error;
    error.stamp = pair.stamp + options_.delay;
    error.desired = pair.command;
    error.observed = pair.observation;
    error.corrected = wasCorrected(pair.stamp);
    latest_ = error;

    Sums& sums = sums_[error.corrected ? 1 : 0];
    sums.samples.push_back({error.position(), error.angle(), 1});
    sums.position += error.position();
    sums.angle += error.angle();
    if (sums.samples.size() > kMeanSamples) {
      sums.position -= sums.samples.front().position;
      sums.angle -= sums.samples.front().angle;
      sums.samples.pop_front();
    }

    if (!errors_.empty() && error.stamp < errors_.back().stamp - kJumpBack) errors_.clear();
    if (errors_.empty() || error.stamp - errors_.back().stamp >= options_.error_period)
      errors_.push_back(error);
    while (!errors_.empty() && errors_.front().stamp < error.stamp - options_.error_duration)
      errors_.pop_front();
  }
}

MeanError OverlayHistory::mean(bool corrected) const {
  const Sums& sums = sums_[corrected ? 1 : 0];
  const std::size_t n = sums.samples.size();
  if (n == 0) return {};
  return {sums.position / static_cast<double>(n), sums.angle / static_cast<double>(n), n};
}

}  // namespace raven_correction
