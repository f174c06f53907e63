// SPDX-License-Identifier: BSD-3-Clause
#include "raven_correction/cleaning/cleaning.h"

#include <cmath>
#include <map>

#include "raven_correction/cleaning/least_median.h"
#include "raven_correction/error.h"

namespace raven_correction {
namespace {

void checkOptions(const CleaningOptions& options) {
  const struct {
    const char* name;
    double value;
  } limits[] = {{"rotation_window", options.limits.rotation_window},
                {"workspace_margin", options.limits.workspace_margin},
                {"speed", options.limits.speed},
                {"angular_speed", options.limits.angular_speed},
                {"step", options.limits.step},
                {"least_median_threshold", options.least_median_threshold}};
  for (const auto& limit : limits)
    if (!(limit.value >= 0.0) || !std::isfinite(limit.value))
      throw InvalidInput(format("cleaning: %s = %g must be >= 0 and finite; 0 switches it off",
                                limit.name, limit.value));
  if (!(options.trajectory_share > 0.0) || options.trajectory_share > 1.0)
    throw InvalidInput(
        format("cleaning: trajectory_share = %g is outside (0, 1]", options.trajectory_share));
}

/// Mean orientation over the samples within `window` of it, from the mean of all, until it rests.
Eigen::Quaterniond windowCentre(const std::vector<CleaningSample>& samples, double window) {
  std::vector<Eigen::Quaterniond> inside;
  for (const CleaningSample& sample : samples) inside.push_back(sample.observation.q);
  Eigen::Quaterniond centre = meanRotation(inside);
  for (int iteration = 0; iteration < 10; ++iteration) {
    inside.clear();
    for (const CleaningSample& sample : samples)
      if (rotationAngle(centre, sample.observation.q) <= window)
        inside.push_back(sample.observation.q);
    if (inside.empty()) break;
    const Eigen::Quaterniond next = meanRotation(inside);
    const double moved = rotationAngle(centre, next);
    centre = next;
    if (moved < 1e-6) break;
  }
  return centre;
}

void applyLimits(const std::vector<CleaningSample>& samples, const PhysicalLimits& limits,
                 CleaningResult& result) {
  if (limits.rotation_window > 0.0)
    result.mean_orientation = windowCentre(samples, limits.rotation_window);
  Eigen::Vector3d low = samples.front().command.p, high = low;
  for (const CleaningSample& sample : samples) {
    low = low.cwiseMin(sample.command.p);
    high = high.cwiseMax(sample.command.p);
  }
  low.array() -= limits.workspace_margin;
  high.array() += limits.workspace_margin;
  const auto exceeds = [](double value, double limit) { return limit > 0.0 && !(value <= limit); };
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const CleaningSample& sample = samples[i];
    const Eigen::Vector3d& p = sample.observation.p;
    if (exceeds(sample.step, limits.step)) {
      result.fates[i] = Fate::kLongStep;
    } else if (exceeds(rotationAngle(result.mean_orientation, sample.observation.q),
                       limits.rotation_window)) {
      result.fates[i] = Fate::kRotationWindow;
    } else if (limits.workspace_margin > 0.0 &&
               !((p.array() >= low.array()).all() && (p.array() <= high.array()).all())) {
      result.fates[i] = Fate::kWorkspace;
    } else if (exceeds(sample.twist.v.norm(), limits.speed)) {
      result.fates[i] = Fate::kSpeed;
    } else if (exceeds(sample.twist.w.norm(), limits.angular_speed)) {
      result.fates[i] = Fate::kAngularSpeed;
    }
  }
}

void applyLeastMedian(const std::vector<CleaningSample>& samples, const CleaningOptions& options,
                      CleaningResult& result) {
  LeastMedianProblem problem;
  problem.rotation_length = options.rotation_length;
  problem.seed = options.seed;
  std::vector<std::size_t> kept;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    if (result.fates[i] != Fate::kKept) continue;
    kept.push_back(i);
    problem.from.push_back(samples[i].observation);
    problem.to.push_back(samples[i].command);
  }
  const LeastMedianResult fit = fitLeastMedian(problem);
  if (fit.status != LeastMedianResult::Status::kOk) return;
  result.least_median_scale = fit.scale;
  // Rounding of exact data must not count as an outlier: 1e-9 m is below any tracker.
  const double limit = std::max(options.least_median_threshold * fit.scale, 1e-9);
  for (std::size_t k = 0; k < kept.size(); ++k)
    if (!(fit.residuals[k] <= limit)) result.fates[kept[k]] = Fate::kLeastMedian;
}

void rejectTrajectories(const std::vector<CleaningSample>& samples, double share,
                        std::vector<Fate>& fates) {
  struct Count {
    std::size_t all = 0, rejected = 0;
  };
  std::map<std::size_t, Count> counts;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    Count& count = counts[samples[i].trajectory];
    ++count.all;
    if (fates[i] != Fate::kKept) ++count.rejected;
  }
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const Count& count = counts[samples[i].trajectory];
    if (fates[i] == Fate::kKept &&
        static_cast<double>(count.rejected) > share * static_cast<double>(count.all))
      fates[i] = Fate::kTrajectoryRejected;
  }
}

}  // namespace

CleaningResult clean(const std::vector<CleaningSample>& samples, const CleaningOptions& options) {
  checkOptions(options);
  CleaningResult result;
  result.fates.assign(samples.size(), Fate::kKept);
  if (!samples.empty()) {
    applyLimits(samples, options.limits, result);
    if (options.least_median_threshold > 0.0) applyLeastMedian(samples, options, result);
    rejectTrajectories(samples, options.trajectory_share, result.fates);
  }
  for (const Fate fate : result.fates) ++result.counts[fate];
  result.status = result.counts[Fate::kKept] > 0 ? CleaningResult::Status::kOk
                                                 : CleaningResult::Status::kNothingLeft;
  return result;
}

}  // namespace raven_correction
