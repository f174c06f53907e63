// SPDX-License-Identifier: BSD-3-Clause
#include "raven_correction/dataset/synchronisation.h"

#include <cmath>
#include <numeric>

#include "raven_correction/error.h"
#include "raven_correction/geometry/statistics.h"

namespace raven_correction {

const char* fateName(Fate fate) noexcept {
  switch (fate) {
    case Fate::kKept:
      return "kept";
    case Fate::kNotFinite:
      return "not_finite";
    case Fate::kNotUnit:
      return "not_unit";
    case Fate::kRepeated:
      return "repeated";
    case Fate::kNoCommand:
      return "no_command";
    case Fate::kCommandGap:
      return "command_gap";
    case Fate::kLongStep:
      return "long_step";
    case Fate::kRotationWindow:
      return "rotation_window";
    case Fate::kWorkspace:
      return "workspace";
    case Fate::kSpeed:
      return "speed";
    case Fate::kAngularSpeed:
      return "angular_speed";
    case Fate::kLeastMedian:
      return "least_median";
    case Fate::kTrajectoryRejected:
      return "trajectory_rejected";
    case Fate::kCount:
      break;
  }
  return "unknown";
}

std::size_t FateCounts::total() const {
  return std::accumulate(count.begin(), count.end(), std::size_t{0});
}

FateCounts& FateCounts::operator+=(const FateCounts& other) {
  for (std::size_t i = 0; i < count.size(); ++i) count[i] += other.count[i];
  return *this;
}

namespace {

/// kKept, kNotFinite or kNotUnit: what can be said of a sample without its neighbours.
Fate plausibility(const StampedPose& sample) {
  if (!std::isfinite(sample.stamp) || !isFinite(sample.pose)) return Fate::kNotFinite;
  return hasUnitQuaternion(sample.pose) ? Fate::kKept : Fate::kNotUnit;
}

bool samePose(const Pose& a, const Pose& b) { return a.p == b.p && a.q.coeffs() == b.q.coeffs(); }

}  // namespace

ScreenedStream screenObservations(const PoseStream& stream) {
  ScreenedStream screened;
  screened.index_of.reserve(stream.size());
  screened.fate.reserve(stream.size());
  for (const StampedPose& sample : stream) {
    Fate fate = plausibility(sample);
    if (fate == Fate::kKept && !screened.samples.empty() &&
        (sample.stamp <= screened.samples.back().stamp ||
         samePose(sample.pose, screened.samples.back().pose)))
      fate = Fate::kRepeated;
    if (fate == Fate::kKept) screened.samples.push_back(sample);
    const bool real = fate == Fate::kKept || fate == Fate::kRepeated;
    screened.index_of.push_back(real ? screened.samples.size() - 1 : ScreenedStream::npos);
    screened.fate.push_back(fate);
  }
  return screened;
}

ScreenedStream screenCommands(const PoseStream& stream) {
  ScreenedStream screened;
  for (const StampedPose& sample : stream) {
    Fate fate = plausibility(sample);
    const bool identity = fate == Fate::kKept && isIdentity(sample.pose);
    if (identity) ++screened.identity;
    const bool real = fate == Fate::kKept && !identity;
    if (real && !screened.samples.empty() && sample.stamp <= screened.samples.back().stamp) {
      fate = Fate::kRepeated;
      if (sample.stamp == screened.samples.back().stamp) screened.samples.back() = sample;
    } else if (real) {
      screened.samples.push_back(sample);
    }
    screened.index_of.push_back(real ? screened.samples.size() - 1 : ScreenedStream::npos);
    screened.fate.push_back(fate);
  }
  return screened;
}

double commandGapLimit(const Dataset& dataset, const SynchronisationOptions& options) {
  if (options.max_gap > 0.0) return options.max_gap;
  std::vector<double> periods;
  for (const Trajectory& trajectory : dataset.trajectories)
    for (std::size_t i = 1; i < trajectory.commands.size(); ++i) {
      const double period = trajectory.commands[i].stamp - trajectory.commands[i - 1].stamp;
      if (period > 0.0) periods.push_back(period);
    }
  return periods.empty() ? 0.0 : options.max_gap_periods * median(std::move(periods));
}

namespace {

SynchronisedTrajectory synchroniseOne(const Trajectory& trajectory, double delay, double max_gap) {
  SynchronisedTrajectory result;
  result.id = trajectory.id;
  result.observations = screenObservations(trajectory.observations);
  const ScreenedStream commands = screenCommands(trajectory.commands);
  result.identity_commands = commands.identity;
  for (const Fate fate : result.observations.fate)
    if (fate != Fate::kKept) ++result.fates[fate];
  for (std::size_t i = 0; i < result.observations.samples.size(); ++i) {
    const double instant = result.observations.samples[i].stamp - delay;
    const bool covered = !commands.samples.empty() && instant >= commands.samples.front().stamp &&
                         instant <= commands.samples.back().stamp;
    const auto command = poseAt(commands.samples, instant, max_gap);
    ++result.fates[!covered ? Fate::kNoCommand : command ? Fate::kKept : Fate::kCommandGap];
    if (command) result.pairs.push_back({i, *command});
  }
  return result;
}

}  // namespace

std::vector<SynchronisedTrajectory> synchronise(const Dataset& dataset,
                                                const SynchronisationOptions& options) {
  if (!std::isfinite(options.delay))
    throw InvalidInput(format("delay = %g s is not finite", options.delay));
  if (!(options.max_gap >= 0.0) || !(options.max_gap_periods > 0.0))
    throw InvalidInput(format("max_gap = %g s must be >= 0 and max_gap_periods = %g > 0",
                              options.max_gap, options.max_gap_periods));
  bool any = false;
  for (const Trajectory& trajectory : dataset.trajectories)
    any |= !trajectory.commands.empty() && !trajectory.observations.empty();
  if (!any)
    throw InvalidInput(
        format("%s: no trajectory has both a command and an observation stream of poses (%zu "
               "trajectories); are servo_cp and mocap/measured_cp recorded?",
               dataset.source.c_str(), dataset.trajectories.size()));
  const double max_gap = commandGapLimit(dataset, options);
  std::vector<SynchronisedTrajectory> result;
  result.reserve(dataset.trajectories.size());
  for (const Trajectory& trajectory : dataset.trajectories)
    result.push_back(synchroniseOne(trajectory, options.delay, max_gap));
  return result;
}

}  // namespace raven_correction
