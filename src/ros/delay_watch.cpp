// SPDX-License-Identifier: BSD-3-Clause
#include "raven_correction/ros/delay_watch.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "raven_correction/dataset/speed_delay.h"
#include "raven_correction/error.h"

namespace raven_correction {
namespace {

constexpr double kPeriod = 0.005;          // between samples that are kept [s]
constexpr double kRenewed = 0.25;          // share of the window between two estimates [-]
constexpr double kFilled = 0.5;            // share of the window that both streams must fill [-]
constexpr double kStampResolution = 1e-6;  // of a time of today as a double, and more [s]

double duration(const PoseStream& stream) {
  return stream.empty() ? 0.0 : stream.back().stamp - stream.front().stamp;
}

}  // namespace

DelayWatch::DelayWatch(const DelayWatchOptions& options) : options_(options) {
  if (!(options.window > 0.0) || !(options.max_change >= 0.0) ||
      !std::isfinite(options.window + options.max_change))
    throw InvalidInput(format("delay_window = %g s must be > 0, max_delay_change = %g s >= 0",
                              options.window, options.max_change));
}

void DelayWatch::setModel(const std::string& id, double delay) {
  if (id == model_ && (delay == model_delay_ || (std::isnan(delay) && std::isnan(model_delay_))))
    return;
  model_ = id;
  model_delay_ = delay;
  status_ = DelayResult::Status::kNotRun;
  message_.clear();
  estimated_at_ = -std::numeric_limits<double>::infinity();
  stale_ = estimate_.valid();
}

void DelayWatch::clear() {
  commands_.clear();
  observations_.clear();
  const std::string model = model_;
  const double delay = model_delay_;
  model_delay_ = std::numeric_limits<double>::quiet_NaN();
  setModel(model, delay);
}

void DelayWatch::add(const StampedPose& sample, PoseStream& stream) {
  if (options_.max_change == 0.0 || !std::isfinite(sample.stamp) || !(sample.stamp > 0.0)) return;
  if (!stream.empty() && sample.stamp < stream.back().stamp - options_.window) stream.clear();
  if (!stream.empty() && sample.stamp < stream.back().stamp + kPeriod - kStampResolution) return;
  stream.push_back(sample);
  // Half of what is stored may be too old before it is moved out: constant cost per sample.
  const double oldest = sample.stamp - options_.window;
  if (stream[stream.size() / 2].stamp >= oldest) return;
  stream.erase(stream.begin(), stream.begin() + static_cast<std::ptrdiff_t>(stream.size() / 2));
}

void DelayWatch::update() {
  if (estimate_.valid()) {
    if (estimate_.wait_for(std::chrono::seconds(0)) != std::future_status::ready) return;
    const DelayResult result = estimate_.get();
    if (!stale_) take(result);
    stale_ = false;
  }
  if (!std::isfinite(model_delay_) || observations_.empty() || commands_.empty()) return;
  // Of what one of the streams has not said yet (it is on its way, or silent) nothing is known.
  const double newest = std::min(observations_.back().stamp, commands_.back().stamp + model_delay_);
  if (newest < estimated_at_) estimated_at_ = newest;  // the stream began anew
  if (newest - estimated_at_ < kRenewed * options_.window) return;
  if (std::min(duration(commands_), duration(observations_)) < kFilled * options_.window) return;
  estimated_at_ = newest;

  Dataset window;
  window.trajectories.resize(1);
  window.trajectories.front().commands = commands_;
  PoseStream& seen = window.trajectories.front().observations;
  const auto first = std::find_if(
      observations_.begin(), observations_.end(),
      [&](const StampedPose& sample) { return sample.stamp >= newest - options_.window; });
  seen.assign(first, observations_.end());
  SpeedDelayProblem problem;
  problem.min = model_delay_ - kRange;
  problem.max = model_delay_ + kRange;
  estimate_ = std::async(std::launch::async, [window = std::move(window), problem] {
    return estimateSpeedDelay(window, problem);
  });
}

void DelayWatch::take(const DelayResult& result) {
  status_ = result.status;
  delay_ = result.delay;
  message_.clear();
  const double change = delay_ - model_delay_;
  if (!known() || (!atLimit() && !(std::abs(change) > options_.max_change))) return;
  message_ = format(
      "motion capture is %.3f s behind the commands (by speeds), %.3f s in what model %s was "
      "trained on: %s%.3f s %s; has a clock of one host been set, does one run off (chrony), or is "
      "the robot another? with clocks "
      "in order, train again",
      delay_, model_delay_, model_.c_str(), atLimit() ? "at least " : "", std::abs(change),
      change > 0.0 ? "more" : "less");
}

}  // namespace raven_correction
