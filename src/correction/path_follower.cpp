// SPDX-License-Identifier: BSD-3-Clause
#include "raven_correction/correction/path_follower.h"

#include <algorithm>
#include <cmath>

namespace raven_correction {
namespace {

constexpr double kNear = 1e-6;  // a pose of the stream is this near to that of the path [m, rad]
constexpr std::size_t kMostSkipped = 25;  // poses of which the corrector saw the newest alone
constexpr double kLongestPeriod = 0.2;    // of a stream [s]
constexpr double kPaceTolerance = 0.5;    // of a stamp from where the pace puts it, in periods [-]

}  // namespace

bool isPathPose(const Pose& pose, const Pose& of_path) noexcept {
  return (pose.p - of_path.p).norm() < kNear && rotationAngle(pose.q, of_path.q) < kNear;
}

PathFollower::PathFollower() { path_.reserve(kCapacity); }

void PathFollower::begin() noexcept {
  path_.clear();
  too_long_ = false;
  state_ = {};
  state_.lost = false;
  before_ = state_;
}

void PathFollower::add(const Pose& pose) noexcept {
  if (path_.size() == kCapacity) {
    too_long_ = true;
    return;
  }
  path_.push_back(pose);
}

/// The pose that it is: of several that are equal (the tool rests) the one that is due.
std::optional<std::size_t> PathFollower::find(double stamp, const Pose& desired) const noexcept {
  const std::size_t first = state_.followed ? state_.last + 1 : 0;
  const std::size_t end = std::min(path_.size(), first + 1 + kMostSkipped);
  double due = static_cast<double>(first);
  if (state_.period > 0.0)
    due = static_cast<double>(state_.last) + (stamp - state_.stamp) / state_.period;
  std::optional<std::size_t> best;
  for (std::size_t i = first; i < end; ++i) {
    if (!isPathPose(path_[i], desired)) continue;
    if (!best ||
        std::abs(static_cast<double>(i) - due) < std::abs(static_cast<double>(*best) - due))
      best = i;
  }
  return best;
}

void PathFollower::follow(double stamp, const Pose& desired) noexcept {
  before_ = state_;
  if (state_.lost) return;
  const auto place = too_long_ ? std::nullopt : find(stamp, desired);
  if (!place) {
    state_.lost = true;
    return;
  }
  const double steps = static_cast<double>(*place - state_.last);
  const double elapsed = stamp - state_.stamp;
  const double off = elapsed - steps * state_.period;
  const bool anew = !state_.followed || !(elapsed > 0.0) || elapsed > steps * kLongestPeriod ||
                    (state_.period > 0.0 && !(std::abs(off) < kPaceTolerance * state_.period));
  state_.last = *place;
  state_.stamp = stamp;
  state_.followed = true;
  if (anew) {
    state_.anchor = *place;
    state_.anchor_stamp = stamp;
    state_.period = 0.0;
    return;
  }
  state_.period = (stamp - state_.anchor_stamp) / static_cast<double>(state_.last - state_.anchor);
}

std::optional<Pose> PathFollower::ahead(double lead) const noexcept {
  if (state_.lost || !(state_.period > 0.0) || !(lead >= 0.0)) return std::nullopt;
  const double place = static_cast<double>(state_.last) + lead / state_.period;
  const auto end = static_cast<double>(path_.size() - 1);
  if (!(place < end)) return path_.back();
  const auto before = static_cast<std::size_t>(place);
  return interpolate(path_[before], path_[before + 1], place - static_cast<double>(before));
}

}  // namespace raven_correction
