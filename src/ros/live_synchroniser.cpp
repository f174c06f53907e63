// SPDX-License-Identifier: BSD-3-Clause
#include "raven_correction/ros/live_synchroniser.h"

#include <algorithm>
#include <cmath>

#include "raven_correction/error.h"
#include "raven_correction/geometry/statistics.h"

namespace raven_correction {
namespace {

constexpr std::size_t kPeriods = 65;  // odd, so that the median is one of them

/// kKept, kNotFinite or kNotUnit: what can be said of a sample without its neighbours. A stamp
/// that is not positive means "not valid" and counts as not finite.
Fate plausibility(const StampedPose& sample) {
  if (!(std::isfinite(sample.stamp) && sample.stamp > 0.0) || !isFinite(sample.pose))
    return Fate::kNotFinite;
  return hasUnitQuaternion(sample.pose) ? Fate::kKept : Fate::kNotUnit;
}

bool samePose(const Pose& a, const Pose& b) { return a.p == b.p && a.q.coeffs() == b.q.coeffs(); }

}  // namespace

LiveSynchroniser::LiveSynchroniser(const LiveSynchroniserOptions& options) : options_(options) {
  if (!(options.max_gap >= 0.0) || !(options.max_gap_periods > 0.0) || !(options.horizon > 0.0) ||
      !std::isfinite(options.max_gap + options.max_gap_periods + options.horizon))
    throw InvalidInput(
        format("max_gap = %g s must be >= 0, max_gap_periods = %g and horizon = %g s > 0",
               options.max_gap, options.max_gap_periods, options.horizon));
}

void LiveSynchroniser::clear() {
  commands_.clear();
  waiting_.clear();
  last_observation_.reset();
  periods_.clear();
  automatic_gap_ = 0.0;
  periods_changed_ = false;
}

void LiveSynchroniser::restart() {
  fates_[Fate::kNoCommand] += waiting_.size();
  clear();
  ++restarts_;
}

double LiveSynchroniser::gapLimit() {
  if (options_.max_gap > 0.0) return options_.max_gap;
  if (periods_changed_) {
    automatic_gap_ =
        options_.max_gap_periods * median(std::vector<double>(periods_.begin(), periods_.end()));
    periods_changed_ = false;
  }
  return automatic_gap_;
}

std::vector<LivePair> LiveSynchroniser::addCommand(const StampedPose& command) {
  if (plausibility(command) != Fate::kKept || isIdentity(command.pose)) return {};
  if (!commands_.empty() && command.stamp <= commands_.back().stamp) {
    if (command.stamp < commands_.back().stamp - options_.horizon) {
      restart();
    } else {  // of equal stamps the last one stays: it is the one that the robot follows
      if (command.stamp == commands_.back().stamp) commands_.back() = command;
      return {};
    }
  }
  if (!commands_.empty()) {
    periods_.push_back(command.stamp - commands_.back().stamp);
    if (periods_.size() > kPeriods) periods_.pop_front();
    periods_changed_ = true;
  }
  commands_.push_back(command);
  std::vector<LivePair> pairs = resolve();
  trimCommands();
  return pairs;
}

std::vector<LivePair> LiveSynchroniser::addObservation(const StampedPose& observation) {
  Fate fate = plausibility(observation);
  if (fate == Fate::kKept && last_observation_) {
    if (observation.stamp < last_observation_->stamp - options_.horizon)
      restart();
    else if (observation.stamp <= last_observation_->stamp ||
             samePose(observation.pose, last_observation_->pose))
      fate = Fate::kRepeated;
  }
  if (fate != Fate::kKept) {
    ++fates_[fate];
    return {};
  }
  last_observation_ = observation;
  waiting_.push_back(observation);
  std::vector<LivePair> pairs = resolve();
  while (!waiting_.empty() && waiting_.front().stamp < observation.stamp - options_.horizon) {
    ++fates_[Fate::kNoCommand];
    waiting_.pop_front();
  }
  return pairs;
}

std::vector<LivePair> LiveSynchroniser::resolve() {
  std::vector<LivePair> pairs;
  while (!waiting_.empty() && !commands_.empty() &&
         waiting_.front().stamp <= commands_.back().stamp) {
    const StampedPose& observation = waiting_.front();
    const bool covered = observation.stamp >= commands_.front().stamp;
    const auto command = poseAt(commands_, observation.stamp, gapLimit());
    ++fates_[!covered ? Fate::kNoCommand : command ? Fate::kKept : Fate::kCommandGap];
    if (command) pairs.push_back({observation.stamp, *command, observation.pose});
    waiting_.pop_front();
  }
  return pairs;
}

void LiveSynchroniser::trimCommands() {
  // Half of what is stored may be too old before it is moved out: constant cost per command.
  const double oldest = commands_.back().stamp - options_.horizon;
  const std::size_t middle = commands_.size() / 2;
  if (commands_[middle].stamp >= oldest) return;
  commands_.erase(commands_.begin(), commands_.begin() + static_cast<std::ptrdiff_t>(middle));
}

}  // namespace raven_correction
