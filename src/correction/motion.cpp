// SPDX-License-Identifier: BSD-3-Clause
#include "raven_correction/correction/motion.h"

#include <algorithm>
#include <cmath>

#include "raven_correction/error.h"
#include "raven_correction/geometry/differentiation.h"

namespace raven_correction {

VelocityKind velocityFromName(const std::string& name) {
  for (const VelocityKind kind :
       {VelocityKind::kNone, VelocityKind::kCentral, VelocityKind::kCausal})
    if (name == velocityName(kind)) return kind;
  throw InvalidInput(
      format("velocity \"%s\" is not known; one of none, central, causal", name.c_str()));
}

const char* velocityName(VelocityKind kind) noexcept {
  switch (kind) {
    case VelocityKind::kNone:
      return "none";
    case VelocityKind::kCentral:
      return "central";
    case VelocityKind::kCausal:
      break;
  }
  return "causal";
}

void checkMotionOptions(const MotionOptions& options) {
  if (!(options.window > 0.0) || options.window > 10.0)
    throw InvalidInput(format("velocity window = %g s is outside (0, 10]", options.window));
  if (!(options.max_gap > 0.0) || options.max_gap > 10.0)
    throw InvalidInput(format("max_gap = %g s is outside (0, 10]", options.max_gap));
  if (options.lags.size() > kMaxLags)
    throw InvalidInput(format("%zu velocity lags, at most %zu", options.lags.size(), kMaxLags));
  for (const double lag : options.lags)
    if (!(lag >= 0.0) || lag > 10.0)
      throw InvalidInput(format("velocity lag = %g s is outside [0, 10]", lag));
}

std::size_t twistCount(const MotionOptions& options) noexcept {
  switch (options.velocity) {
    case VelocityKind::kNone:
      return 0;
    case VelocityKind::kCentral:
      return 1;
    case VelocityKind::kCausal:
      break;
  }
  return options.lags.size();
}

MotionEstimator::MotionEstimator(const MotionOptions& options)
    : options_(options), samples_(2 * kCapacity) {
  checkMotionOptions(options_);
  if (options_.velocity == VelocityKind::kCentral) options_.lags = {0.0};
  if (options_.velocity == VelocityKind::kNone) options_.lags.clear();
  double reach = options_.window;
  for (const double lag : options_.lags) reach = std::max(reach, lag + options_.window);
  thinning_ = 2.0 * reach / static_cast<double>(kCapacity);
}

void MotionEstimator::reset() noexcept {
  started_ = false;
  count_ = 0;
}

void MotionEstimator::remember(const StampedPose& sample) noexcept {
  // A burst overwrites the newest place, so that the history always reaches far enough back.
  if (count_ >= 2 && sample.stamp - samples_[count_ - 2].stamp < thinning_) {
    samples_[count_ - 1] = sample;
    return;
  }
  if (count_ == samples_.size()) {
    std::copy(samples_.begin() + kCapacity, samples_.end(), samples_.begin());
    count_ = kCapacity;
  }
  samples_[count_++] = sample;
}

MotionEstimator::Outcome MotionEstimator::push(double stamp, const Pose& pose) noexcept {
  if (!std::isfinite(stamp) || !isFinite(pose)) return Outcome::kNotFinite;
  if (!hasUnitQuaternion(pose)) return Outcome::kNotUnit;
  if (started_ && stamp < last_stamp_) return Outcome::kBackwards;
  if (started_ && stamp == last_stamp_) return Outcome::kRepeated;
  const double step = started_ ? stamp - last_stamp_ : 0.0;
  if (step > options_.max_gap) count_ = 0;
  started_ = true;
  last_stamp_ = stamp;
  motion_.pose = {pose.p, pose.q.normalized()};
  motion_.step = step;
  remember({stamp, motion_.pose});
  for (std::size_t k = 0; k < options_.lags.size(); ++k) {
    std::size_t count = count_;
    while (count > 0 && samples_[count - 1].stamp > stamp - options_.lags[k]) --count;
    motion_.twists[k] = count > 0 ? causalTwist(samples_.data(), count, options_.window) : Twist();
  }
  return Outcome::kAccepted;
}

std::vector<Motion> motionsOf(const PoseStream& stream, const MotionOptions& options) {
  std::vector<Motion> motions;
  motions.reserve(stream.size());
  MotionEstimator estimator(options);
  for (const StampedPose& sample : stream) {
    estimator.push(sample.stamp, sample.pose);
    motions.push_back(estimator.motion());
  }
  if (options.velocity != VelocityKind::kCentral) return motions;
  std::size_t first = 0;  // of the motion without long gaps that is being differentiated
  for (std::size_t end = 1; end <= stream.size(); ++end) {
    if (end < stream.size() && stream[end].stamp - stream[end - 1].stamp <= options.max_gap)
      continue;
    const PoseStream motion(stream.begin() + static_cast<std::ptrdiff_t>(first),
                            stream.begin() + static_cast<std::ptrdiff_t>(end));
    for (std::size_t i = first; i < end; ++i)
      motions[i].twists[0] = centralTwist(motion, i - first);
    first = end;
  }
  return motions;
}

}  // namespace raven_correction
