// SPDX-License-Identifier: BSD-3-Clause
#include "raven_correction/ros/playback.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "raven_correction/error.h"

namespace raven_correction {
namespace {

constexpr double kPeakSpeed = 1.875;          // of the profile with unit length and duration
constexpr double kPeakAcceleration = 5.7735;  // 10 / sqrt(3)
constexpr double kDefaultPeriod = 0.02;       // of a motion of one sample [s]

double minimumJerk(double u) { return u * u * u * (10.0 + u * (-15.0 + 6.0 * u)); }

}  // namespace

PoseStream smoothMove(const Pose& from, const Pose& to, double speed, double angular_speed,
                      double acceleration, double period) {
  if (!(speed > 0.0 && angular_speed > 0.0 && acceleration > 0.0 && period > 0.0))
    throw InvalidInput(
        format("speed %g m/s, angular speed %g rad/s, acceleration %g m/s^2 and period %g s must "
               "be > 0",
               speed, angular_speed, acceleration, period));
  if (!isFinite(from) || !isFinite(to))
    throw InvalidInput("a move from or to a pose that is not finite");
  const double length = (to.p - from.p).norm();
  const double angle = rotationAngle(from.q, to.q);
  const double duration = std::max({kPeakSpeed * length / speed, kPeakSpeed * angle / angular_speed,
                                    std::sqrt(kPeakAcceleration * length / acceleration)});
  const int steps = std::max(1, static_cast<int>(std::ceil(duration / period)));
  PoseStream motion;
  motion.reserve(static_cast<std::size_t>(steps) + 1);
  for (int k = 0; k < steps; ++k)
    motion.push_back(
        {k * period, interpolate(from, to, minimumJerk(static_cast<double>(k) / steps))});
  motion.push_back({steps * period, to});
  return motion;
}

Playback::Playback(PoseStream motion, double start, double max_late)
    : motion_(std::move(motion)), max_late_(max_late), due_(start) {
  if (motion_.empty()) throw InvalidInput("a motion without commands cannot be played");
  for (std::size_t i = 1; i < motion_.size(); ++i)
    if (!(motion_[i].stamp >= motion_[i - 1].stamp))
      throw InvalidInput(format("command %zu of a motion is earlier than the one before", i));
  if (!(max_late >= 0.0)) throw InvalidInput(format("max_late = %g s, must be >= 0", max_late));
  const double median = medianPeriod(motion_);
  period_ = median > 0.0 ? median : kDefaultPeriod;
}

void Playback::stop(double duration) {
  if (finished_ || stopping()) return;
  stop_duration_ = std::max(0.0, duration);
  // The command sent last; nothing has been sent yet at the very start.
  stop_from_ = motion_[index_ > 0 ? index_ - 1 : 0].stamp;
  if (index_ == 0) finished_ = true;
}

std::optional<StampedPose> Playback::next(double now) {
  if (finished_ || now < due_) return std::nullopt;
  if (now - due_ > max_late_) due_ = now;
  StampedPose command{due_, {}};
  if (!stopping()) {
    command.pose = motion_[index_].pose;
    ++index_;
    if (index_ == motion_.size())
      finished_ = true;
    else
      due_ += motion_[index_].stamp - motion_[index_ - 1].stamp;
    return command;
  }
  // The motion's own time runs at a pace that falls from 1 to 0 during the stop.
  stop_elapsed_ = std::min(stop_elapsed_ + period_, stop_duration_);
  const double share = stop_duration_ > 0.0 ? stop_elapsed_ / stop_duration_ : 1.0;
  const double advanced = stop_elapsed_ * (1.0 - 0.5 * share);
  const double instant = std::min(stop_from_ + advanced, motion_.back().stamp);
  const auto pose = poseAt(motion_, instant, std::numeric_limits<double>::max());
  command.pose = pose ? *pose : motion_.back().pose;
  finished_ = share >= 1.0;
  due_ += period_;
  return command;
}

}  // namespace raven_correction
