// SPDX-License-Identifier: BSD-3-Clause
#include "raven_correction/dataset/delay.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "raven_correction/dataset/synchronisation.h"
#include "raven_correction/error.h"
#include "raven_correction/geometry/rigid_fit.h"
#include "raven_correction/geometry/statistics.h"

namespace raven_correction {

const char* delayStatusText(DelayResult::Status status) noexcept {
  switch (status) {
    case DelayResult::Status::kNotRun:
      return "fixed by the configuration";
    case DelayResult::Status::kOk:
      return "estimated";
    case DelayResult::Status::kAtLimit:
      return "is at the limit of the search: widen delay.max, and check the clocks";
    case DelayResult::Status::kNotObservable:
      break;
  }
  return "is not observable in this recording (too little motion): 0 is used";
}

namespace {

struct Candidate {
  const PoseStream* commands;
  StampedPose observation;
};

/// Observations that have a command for every delay of the search, thinned evenly.
std::vector<Candidate> candidates(const std::vector<PoseStream>& commands,
                                  const std::vector<PoseStream>& observations,
                                  const DelayProblem& problem) {
  std::vector<Candidate> all;
  for (std::size_t k = 0; k < commands.size(); ++k) {
    if (commands[k].empty()) continue;
    for (const StampedPose& observation : observations[k])
      if (observation.stamp - problem.max >= commands[k].front().stamp &&
          observation.stamp - problem.min <= commands[k].back().stamp)
        all.push_back({&commands[k], observation});
  }
  if (all.size() <= problem.max_pairs) return all;
  std::vector<Candidate> thinned;
  const double stride = static_cast<double>(all.size()) / static_cast<double>(problem.max_pairs);
  for (std::size_t i = 0; i < problem.max_pairs; ++i)
    thinned.push_back(all[static_cast<std::size_t>(static_cast<double>(i) * stride)]);
  return thinned;
}

/// Median residual of the positions after a rigid fit to the better half [m].
double trimmedResidual(const std::vector<Pose>& from, const std::vector<Pose>& to) {
  std::vector<std::size_t> chosen(from.size());
  std::iota(chosen.begin(), chosen.end(), std::size_t{0});
  std::vector<double> residual(from.size());
  for (int iteration = 0; iteration < 6; ++iteration) {
    RigidFitProblem fit;
    fit.rotation_length = 0.0;
    for (const std::size_t i : chosen) {
      fit.from.push_back(from[i]);
      fit.to.push_back(to[i]);
    }
    const Pose X = fitRigid(fit).X_b_a;
    for (std::size_t i = 0; i < from.size(); ++i) residual[i] = (X * from[i].p - to[i].p).norm();
    chosen.resize(from.size());
    std::iota(chosen.begin(), chosen.end(), std::size_t{0});
    const auto half = chosen.begin() + static_cast<std::ptrdiff_t>((from.size() + 1) / 2);
    std::nth_element(chosen.begin(), half - 1, chosen.end(), [&](std::size_t a, std::size_t b) {
      return residual[a] < residual[b] || (residual[a] == residual[b] && a < b);
    });
    chosen.erase(half, chosen.end());
  }
  return median(std::move(residual));
}

/// Minimum of the parabola through three neighbours at spacing 1, relative to the middle one.
double parabolaMinimum(double left, double middle, double right) {
  const double curvature = left - 2.0 * middle + right;
  return curvature > 0.0 ? std::clamp(0.5 * (left - right) / curvature, -0.5, 0.5) : 0.0;
}

}  // namespace

DelayResult estimateDelay(const Dataset& dataset, const DelayProblem& problem) {
  if (!(problem.min < problem.max) || !(problem.step > 0.0) || !(problem.max_gap > 0.0))
    throw InvalidInput(
        format("delay search from %g to %g s in steps of %g s over gaps of %g s: "
               "must rise, and steps and gaps be positive",
               problem.min, problem.max, problem.step, problem.max_gap));
  std::vector<PoseStream> commands, observations;
  for (const Trajectory& trajectory : dataset.trajectories) {
    commands.push_back(screenCommands(trajectory.commands).samples);
    observations.push_back(screenObservations(trajectory.observations).samples);
  }
  const std::vector<Candidate> chosen = candidates(commands, observations, problem);

  const auto steps = static_cast<int>(std::lround((problem.max - problem.min) / problem.step));
  std::vector<std::vector<Pose>> to(static_cast<std::size_t>(steps) + 1);
  std::vector<Pose> from;
  for (const Candidate& candidate : chosen) {
    std::vector<Pose> column;
    for (int k = 0; k <= steps; ++k) {
      const double delay = problem.min + k * problem.step;
      const auto command =
          poseAt(*candidate.commands, candidate.observation.stamp - delay, problem.max_gap);
      if (!command) break;
      column.push_back(*command);
    }
    if (column.size() != to.size()) continue;
    from.push_back(candidate.observation.pose);
    for (std::size_t k = 0; k < to.size(); ++k) to[k].push_back(column[k]);
  }

  DelayResult result;
  result.pairs = from.size();
  result.status = DelayResult::Status::kNotObservable;
  if (from.size() < 20) return result;
  for (int k = 0; k <= steps; ++k) {
    result.tried.push_back(problem.min + k * problem.step);
    result.residual.push_back(trimmedResidual(from, to[static_cast<std::size_t>(k)]));
  }
  const auto best = std::min_element(result.residual.begin(), result.residual.end());
  const auto worst = std::max_element(result.residual.begin(), result.residual.end());
  if (*worst - *best <= 0.02 * *worst) return result;  // flat: nothing moved
  const auto index = best - result.residual.begin();
  result.delay = result.tried[static_cast<std::size_t>(index)];
  result.status = DelayResult::Status::kAtLimit;
  if (index == 0 || index == steps) return result;
  result.status = DelayResult::Status::kOk;
  result.delay += problem.step * parabolaMinimum(*(best - 1), *best, *(best + 1));
  return result;
}

}  // namespace raven_correction
