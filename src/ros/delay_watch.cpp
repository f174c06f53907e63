// SPDX-License-Identifier: BSD-3-Clause
#include "raven_correction/ros/delay_watch.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "raven_correction/error.h"

namespace raven_correction {
namespace {

constexpr double kPeriod = 0.005;          // between samples that are kept [s]
constexpr double kStep = 0.01;             // of the search, and between instants compared [s]
constexpr double kStroke = 0.1;            // over which a speed is taken [s]
constexpr double kLongestGap = 0.1;        // of a stream that is bridged [s]
constexpr double kFastest = 0.4;           // faster is no robot [m/s]
constexpr double kLeastMotion = 2e-4;      // deviation of the strokes of the commands [m]
constexpr double kLeastCorrelation = 0.7;  // of speeds that belong together [-]
constexpr std::size_t kFewest = 200;       // instants compared [1]
constexpr double kRenewed = 0.25;          // share of the window between two estimates [-]
constexpr double kFilled = 0.5;            // share of the window that both streams must fill [-]
constexpr double kStampResolution = 1e-6;  // of a time of today as a double, and more [s]

double duration(const PoseStream& stream) {
  return stream.empty() ? 0.0 : stream.back().stamp - stream.front().stamp;
}

/// How far the tool came within kStroke before each instant [m]; nan across a gap.
std::vector<double> strokes(const PoseStream& stream, double first, std::size_t count) {
  std::vector<double> all(count, std::numeric_limits<double>::quiet_NaN());
  for (std::size_t i = 0; i < count; ++i) {
    const double t = first + kStep * static_cast<double>(i);
    const auto here = poseAt(stream, t, kLongestGap),
               there = poseAt(stream, t - kStroke, kLongestGap);
    if (here && there) all[i] = std::min((here->p - there->p).norm(), kFastest * kStroke);
  }
  return all;
}

/// Correlation of the observed strokes with those of the commands `shift` steps before, and the
/// standard deviation of the latter [m].
struct Agreement {
  double correlation = -1.0, deviation = 0.0;
  std::size_t count = 0;
};
Agreement agreement(const std::vector<double>& observed, const std::vector<double>& commanded,
                    std::size_t shift) {
  double n = 0.0, x = 0.0, y = 0.0, xx = 0.0, yy = 0.0, xy = 0.0;
  for (std::size_t i = 0; i < observed.size(); ++i) {
    const double a = observed[i], b = commanded[i + shift];
    if (!std::isfinite(a) || !std::isfinite(b)) continue;
    n += 1.0;
    x += a;
    y += b;
    xx += a * a;
    yy += b * b;
    xy += a * b;
  }
  Agreement result;
  result.count = static_cast<std::size_t>(n);
  if (result.count < 2) return result;
  const double vx = xx / n - x * x / (n * n), vy = yy / n - y * y / (n * n);
  result.deviation = std::sqrt(std::max(0.0, vy));
  if (vx > 0.0 && vy > 0.0) result.correlation = (xy / n - x * y / (n * n)) / std::sqrt(vx * vy);
  return result;
}

/// The delay at which the speed of the tool is most like that of its commands: errors of the robot
/// that stay, and registration, hardly change a speed, so a few motions tell it.
DelayResult delayBySpeed(const PoseStream& commands, const PoseStream& observations, double start,
                         double end, double least, double most) {
  DelayResult result;
  result.status = DelayResult::Status::kNotObservable;
  const auto steps = static_cast<std::size_t>(std::lround((most - least) / kStep));
  const auto count = static_cast<std::size_t>((end - start) / kStep);
  const std::vector<double> observed = strokes(observations, start, count);
  // Command k is that of the instant start - most + k steps.
  const std::vector<double> commanded = strokes(commands, start - most, count + steps);
  std::size_t best = 0;
  std::vector<double> correlation;
  for (std::size_t shift = 0; shift <= steps; ++shift) {
    const Agreement found = agreement(observed, commanded, shift);
    correlation.push_back(found.correlation);
    result.pairs = std::max(result.pairs, found.count);
    if (found.count < kFewest || found.deviation < kLeastMotion) return result;
    if (found.correlation > correlation[best]) best = shift;
  }
  if (correlation[best] < kLeastCorrelation) return result;
  result.status = DelayResult::Status::kAtLimit;
  result.delay = most - kStep * static_cast<double>(best);
  if (best == 0 || best == steps) return result;
  result.status = DelayResult::Status::kOk;
  const double left = correlation[best - 1], right = correlation[best + 1];
  const double curvature = left - 2.0 * correlation[best] + right;
  if (curvature < 0.0) result.delay -= kStep * 0.5 * (left - right) / curvature;
  return result;
}

}  // namespace

DelayWatch::DelayWatch(const DelayWatchOptions& options) : options_(options) {
  if (!(options.window > 0.0) || !(options.max_change >= 0.0) ||
      !std::isfinite(options.window + options.max_change))
    throw InvalidInput(format("delay_window = %g s must be > 0, max_delay_change = %g s >= 0",
                              options.window, options.max_change));
}

void DelayWatch::setModel(const std::string& id, double delay) {
  if (delay == 0.0) delay = std::numeric_limits<double>::quiet_NaN();
  if (id == model_ && delay == model_delay_) return;
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
  if (!std::isfinite(model_delay_) || observations_.empty()) return;
  const double newest = observations_.back().stamp;
  if (newest < estimated_at_) estimated_at_ = newest;  // the stream began anew
  if (newest - estimated_at_ < kRenewed * options_.window) return;
  if (std::min(duration(commands_), duration(observations_)) < kFilled * options_.window) return;
  estimated_at_ = newest;

  estimate_ =
      std::async(std::launch::async, [commands = commands_, observations = observations_, newest,
                                      window = options_.window, delay = model_delay_] {
        return delayBySpeed(commands, observations, newest - window, newest, delay - kRange,
                            delay + kRange);
      });
}

void DelayWatch::take(const DelayResult& result) {
  status_ = result.status;
  delay_ = result.delay;
  message_.clear();
  const double change = delay_ - model_delay_;
  if (!known() || (!atLimit() && !(std::abs(change) > options_.max_change))) return;
  message_ = format(
      "motion capture is %.3f s behind the commands, %.3f s in the model %s: %s%.3f s %s; has a "
      "clock of one host been set, does one run off (chrony), or is the robot another? with clocks "
      "in order, train again",
      delay_, model_delay_, model_.c_str(), atLimit() ? "at least " : "", std::abs(change),
      change > 0.0 ? "more" : "less");
}

}  // namespace raven_correction
