// SPDX-License-Identifier: BSD-3-Clause
#include "raven_correction/dataset/speed_delay.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "raven_correction/error.h"

namespace raven_correction {
namespace {

constexpr double kStroke = 0.1;        // over which a speed is taken [s]
constexpr double kLongestGap = 0.1;    // of a stream that is bridged [s]
constexpr double kFastest = 0.4;       // faster is no robot [m/s]
constexpr double kLeastMotion = 2e-4;  // deviation of the strokes of the commands [m]
constexpr std::size_t kFewest = 200;   // instants compared [1]

/// How far the tool came within kStroke before each instant [m]; nan across a gap.
std::vector<double> strokes(const PoseStream& stream, double first, double step,
                            std::size_t count) {
  std::vector<double> all(count, std::numeric_limits<double>::quiet_NaN());
  for (std::size_t i = 0; i < count; ++i) {
    const double t = first + step * static_cast<double>(i);
    const auto here = poseAt(stream, t, kLongestGap),
               there = poseAt(stream, t - kStroke, kLongestGap);
    if (here && there) all[i] = std::min((here->p - there->p).norm(), kFastest * kStroke);
  }
  return all;
}

/// Sums over pairs of an observed stroke and that of a command.
struct Sums {
  double n = 0.0, x = 0.0, y = 0.0, xx = 0.0, yy = 0.0, xy = 0.0;

  /// @param shift  of the commands against the observed strokes [steps]
  void add(const std::vector<double>& observed, const std::vector<double>& commanded,
           std::size_t shift) {
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
  }
  double commandedDeviation() const { return std::sqrt(std::max(0.0, yy / n - y * y / (n * n))); }
  double correlation() const {
    const double vx = xx / n - x * x / (n * n), vy = yy / n - y * y / (n * n);
    return vx > 0.0 && vy > 0.0 ? (xy / n - x * y / (n * n)) / std::sqrt(vx * vy) : -1.0;
  }
};

}  // namespace

DelayResult estimateSpeedDelay(const Dataset& dataset, const SpeedDelayProblem& problem) {
  if (!(problem.step > 0.0) || !(problem.min < problem.max))
    throw InvalidInput(format("delay: from %g s to %g s by %g s, but min < max and step > 0",
                              problem.min, problem.max, problem.step));
  const auto steps =
      static_cast<std::size_t>(std::lround((problem.max - problem.min) / problem.step));
  std::vector<Sums> sums(steps + 1);  // by shift: the delay is max - shift * step
  for (const Trajectory& trajectory : dataset.trajectories) {
    if (trajectory.commands.empty() || trajectory.observations.empty()) continue;
    const double start = trajectory.observations.front().stamp;
    const auto count = static_cast<std::size_t>(
        (trajectory.observations.back().stamp - start) / problem.step + 1.0);
    const std::vector<double> observed =
        strokes(trajectory.observations, start, problem.step, count);
    const std::vector<double> commanded =
        strokes(trajectory.commands, start - problem.max, problem.step, count + steps);
    for (std::size_t shift = 0; shift <= steps; ++shift)
      sums[shift].add(observed, commanded, shift);
  }
  DelayResult result;
  result.status = DelayResult::Status::kNotObservable;
  std::size_t best = 0;
  for (std::size_t shift = 0; shift <= steps; ++shift) {
    const Sums& at = sums[shift];
    if (at.n < static_cast<double>(kFewest) || at.commandedDeviation() < kLeastMotion)
      return result;
    result.pairs = std::max(result.pairs, static_cast<std::size_t>(at.n));
    result.tried.push_back(problem.max - problem.step * static_cast<double>(shift));
    result.residual.push_back(1.0 - at.correlation());
    if (result.residual[shift] < result.residual[best]) best = shift;
  }
  if (1.0 - result.residual[best] < problem.least_correlation) return result;
  result.status = DelayResult::Status::kAtLimit;
  result.delay = result.tried[best];
  if (best == 0 || best == steps) return result;
  result.status = DelayResult::Status::kOk;
  const double left = result.residual[best - 1], right = result.residual[best + 1];
  const double curvature = left - 2.0 * result.residual[best] + right;
  if (curvature > 0.0) result.delay -= problem.step * 0.5 * (left - right) / curvature;
  return result;
}

}  // namespace raven_correction
