// SPDX-License-Identifier: BSD-3-Clause
// The streams of stream_check.h held against one another, and a whole recording.
#include <algorithm>
#include <limits>

#include "raven_correction/dataset/delay.h"
#include "raven_correction/dataset/stream_check.h"
#include "raven_correction/dataset/synchronisation.h"
#include "raven_correction/error.h"
#include "raven_correction/geometry/orientation_match.h"
#include "raven_correction/geometry/statistics.h"

namespace raven_correction {
namespace {

using Severity = StreamFinding::Severity;

constexpr std::size_t kEnough = 20;     // samples, before anything is said about them
constexpr double kLeastMotion = 0.005;  // that tells anything, median from the middle [m]
constexpr double kOtherUnits = 100.0;   // one motion this many times the other [-]
constexpr double kEarly = 0.03;         // observations before their commands [s]
constexpr std::size_t kFollowPairs = 600;
constexpr std::size_t kSpreadSamples = 20000;
constexpr double kUnlike = 0.05;   // what is left of turns, before they are doubted [rad]
constexpr double kMirrored = 0.5;  // of that is left if they are mirrored [-]
constexpr double kDegree = 180.0 / M_PI;

/// Positions from all trajectories, evenly chosen where there are more than kSpreadSamples: a
/// session of half an hour has millions. One trajectory at a time is copied [m].
std::vector<Eigen::Vector3d> positionsOf(const Dataset& dataset, PoseStream Trajectory::*stream,
                                         ScreenedStream (*screen)(const PoseStream&)) {
  std::vector<Eigen::Vector3d> positions;
  std::size_t stride = 1, k = 0;
  for (const Trajectory& trajectory : dataset.trajectories)
    for (const StampedPose& sample : screen(trajectory.*stream).samples) {
      if (k++ % stride != 0) continue;
      positions.push_back(sample.pose.p);
      if (positions.size() < kSpreadSamples) continue;
      // Every other one stays, of these and of what is to come.
      for (std::size_t i = 0; 2 * i < positions.size(); ++i) positions[i] = positions[2 * i];
      positions.resize((positions.size() + 1) / 2);
      stride *= 2;
    }
  return positions;
}

/// Each coordinate's median, and the median distance from there [m].
double spreadOf(const std::vector<Eigen::Vector3d>& positions) {
  if (positions.size() < kEnough) return 0.0;
  Eigen::Vector3d middle;
  std::vector<double> values(positions.size());
  for (Eigen::Index k = 0; k < 3; ++k) {
    for (std::size_t i = 0; i < positions.size(); ++i) values[i] = positions[i](k);
    middle(k) = median(values);
  }
  for (std::size_t i = 0; i < positions.size(); ++i) values[i] = (positions[i] - middle).norm();
  return median(values);
}

/// Neither a registration nor a marker that is turned against the tool can mirror its turns.
void checkQuaternionOrder(const std::vector<Eigen::Quaterniond>& told,
                          const std::vector<Eigen::Quaterniond>& seen, const std::string& name,
                          std::vector<StreamFinding>& findings) {
  if (told.size() < kEnough) return;
  const OrientationMatch match = matchOrientations(told, seen);
  if (match.turned < kUnlike || match.mirrored > kMirrored * match.turned) return;
  findings.push_back({Severity::kWarning, name, "orientation",
                      format("turns as commanded to %.1f deg (median), mirrored to %.1f deg",
                             match.turned * kDegree, match.mirrored * kDegree),
                      "x, y, z, w of the tool in the tracker's frame",
                      "write quaternions with w last, not with w first"});
}

}  // namespace

void checkFollowing(const Dataset& dataset, const StreamCheckOptions& options,
                    std::vector<StreamFinding>& findings) {
  const std::string& commands_name = options.names[static_cast<std::size_t>(StreamRole::kCommands)];
  const std::string& observations_name =
      options.names[static_cast<std::size_t>(StreamRole::kObservations)];
  const double commanded = spreadOf(positionsOf(dataset, &Trajectory::commands, screenCommands));
  const double observed =
      spreadOf(positionsOf(dataset, &Trajectory::observations, screenObservations));
  if (commanded > 0.001 && observed > kOtherUnits * commanded) {
    findings.push_back(
        {Severity::kError, observations_name, "units",
         format("the tool moves by %.4g m where it is told to by %.4g m", observed, commanded),
         "about as much", "are positions in millimetres? they must be in metres"});
    return;
  }
  if (commanded < kLeastMotion) return;
  DelayProblem problem;
  problem.min = options.min_delay;
  problem.max = options.max_delay;
  problem.step = 0.02;
  problem.max_pairs = kFollowPairs;
  problem.max_gap = std::max(0.1, commandGapLimit(dataset, {}));
  const DelayResult delay = estimateDelay(dataset, problem);
  if (delay.residual.empty()) return;
  const bool known =
      delay.status == DelayResult::Status::kOk || delay.status == DelayResult::Status::kAtLimit;
  const double left = *std::min_element(delay.residual.begin(), delay.residual.end());
  if (left > options.max_unexplained * commanded) {
    findings.push_back({Severity::kError, observations_name, "motion",
                        format("%.1f mm of a motion of %.1f mm (medians) are not explained by %s",
                               1e3 * left, 1e3 * commanded, commands_name.c_str()),
                        format("at most %.0f %%", 100.0 * options.max_unexplained),
                        "are these the markers of the same arm and tool, do the clocks agree?"});
    return;
  }
  std::vector<double> distances;
  std::vector<Eigen::Quaterniond> commanded_turns, observed_turns;
  for (const Trajectory& trajectory : dataset.trajectories) {
    const PoseStream sent = screenCommands(trajectory.commands).samples;
    for (const StampedPose& seen : screenObservations(trajectory.observations).samples)
      if (const auto command =
              poseAt(sent, seen.stamp - (known ? delay.delay : 0.0), problem.max_gap)) {
        distances.push_back((command->p - seen.pose.p).norm());
        commanded_turns.push_back(command->q);
        observed_turns.push_back(seen.pose.q);
      }
  }
  checkQuaternionOrder(commanded_turns, observed_turns, observations_name, findings);
  if (distances.size() >= kEnough && median(distances) > options.max_error)
    findings.push_back(
        {Severity::kError, observations_name, "distance",
         format("%.0f mm from %s (median)", 1e3 * median(distances), commands_name.c_str()),
         format("at most %.0f mm", 1e3 * options.max_error),
         "measure the registration of the tracker in the base frame anew"});
  if (!known) return;
  if (delay.delay < -kEarly)
    findings.push_back({Severity::kError, observations_name, "clock",
                        format("%.3f s before the commands that they follow", -delay.delay),
                        "observations come after commands",
                        "synchronise the clocks of the hosts (chrony)"});
  else if (delay.status == DelayResult::Status::kAtLimit)
    findings.push_back({Severity::kWarning, observations_name, "clock",
                        format("%.2f s or more behind the commands", delay.delay),
                        format("at most %g s", options.max_delay),
                        "synchronise the clocks of the hosts (chrony)"});
}

std::vector<StreamFinding> checkDataset(const Dataset& dataset, const StreamCheckOptions& options) {
  constexpr double kNotKnown = std::numeric_limits<double>::quiet_NaN();
  StreamCheckOptions of_dataset = options;
  of_dataset.base_frame = dataset.frame;
  StreamCheck check(of_dataset);
  const Pose in_base;
  const auto addPoses = [&](StreamRole role, const PoseStream& stream) {
    for (const StampedPose& sample : stream)
      check.addPose(role, sample.stamp, kNotKnown, dataset.frame, sample.pose, &in_base);
  };
  for (const Trajectory& trajectory : dataset.trajectories) {
    check.startTrajectory();
    addPoses(StreamRole::kCommands, trajectory.commands);
    addPoses(StreamRole::kObservations, trajectory.observations);
    addPoses(StreamRole::kEncoders, trajectory.encoders);
    for (const StampedJoints& sample : trajectory.joint_observations.samples)
      check.addJoints(sample.stamp, kNotKnown, trajectory.joint_observations.names,
                      sample.positions);
  }
  std::vector<StreamFinding> findings;
  for (const StreamRole role : {StreamRole::kCommands, StreamRole::kObservations})
    if (check.count(role) == 0)
      findings.push_back(
          {Severity::kError, of_dataset.names[static_cast<std::size_t>(role)], "missing",
           format("no sample within the %zu trajectories", dataset.trajectories.size()),
           "at least one",
           "record it; if it was recorded, compare its stamps with those of the "
           "trajectories: do the clocks of the hosts agree?"});
  for (StreamFinding& finding : check.findings()) findings.push_back(std::move(finding));
  if (!anyError(findings)) checkFollowing(dataset, of_dataset, findings);
  return findings;
}

}  // namespace raven_correction
