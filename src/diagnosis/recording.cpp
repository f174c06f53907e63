// SPDX-License-Identifier: BSD-3-Clause
#include "raven_correction/diagnosis/recording.h"

#include <algorithm>
#include <cmath>

#include "raven_correction/dataset/synchronisation.h"
#include "raven_correction/error.h"
#include "raven_correction/geometry/rotation.h"
#include "raven_correction/geometry/statistics.h"
#include "raven_correction/robot/inverse_kinematics.h"

namespace raven_correction {
namespace {

using Observation = Recording::Observation;
constexpr double kMostWrong = 0.1;  // largest share of orientations that markers may get wrong [-]
constexpr double kLimitTolerance = 1e-6;  // [rad or m]
constexpr std::size_t kNoiseRuns = 1000;  // of three frames: the noise is known to 2 or 3 percent
constexpr int kMeanRounds = 5;  // of the orientation window: the mean of those inside it, again

/// Joints along a stream of poses: each solution is the seed of the next. Stamps never decrease.
class PoseTracker {
 public:
  explicit PoseTracker(const KinematicChain& robot) : robot_(robot), ik_(robot) {
    seed_ = robot.home();
  }
  /// @return false if no joints reproduce the pose
  bool follow(const Pose& pose, JointVector& joints) {
    const IkResult result = ik_.solve(pose, seed_);
    if (!reproducesPose(result.status)) return false;
    joints = seed_ = result.joints;
    return true;
  }

 private:
  const KinematicChain& robot_;
  InverseKinematics ik_;
  JointVector seed_;
};

void addPoseSetpoints(const PoseStream& stream, bool clamp, const KinematicChain& robot,
                      PoseTracker& tracker, Recording::Motion& motion, Recording::Left& left) {
  const ScreenedStream screened = screenCommands(stream);
  left.setpoints += stream.size();
  left.not_a_command += stream.size() - screened.samples.size();
  for (const StampedPose& sample : screened.samples) {
    Recording::Setpoint setpoint;
    setpoint.stamp = sample.stamp;
    if (!tracker.follow(sample.pose, setpoint.joints)) {
      ++left.unreachable;
      continue;
    }
    if (clamp && !robot.withinLimits(setpoint.joints, kLimitTolerance)) ++left.outside_limits;
    if (clamp) setpoint.joints = robot.clamp(setpoint.joints);  // as the controller does it
    motion.setpoints.push_back(std::move(setpoint));
  }
}

/// Samples of a joint stream that are finite and no repetition of the one before.
std::vector<StampedJoints> screenJoints(const JointStream& stream, Recording::Left& left) {
  std::vector<StampedJoints> samples;
  for (const StampedJoints& sample : stream.samples) {
    ++left.observations;
    if (!std::isfinite(sample.stamp) || !sample.positions.allFinite()) {
      ++left.impossible;
    } else if (!samples.empty() && (sample.stamp <= samples.back().stamp ||
                                    sample.positions == samples.back().positions)) {
      ++left.repeated;
    } else {
      samples.push_back(sample);
    }
  }
  return samples;
}

void addJointObservations(const JointStream& stream, Observation::Kind kind,
                          Recording::Motion& motion, Recording::Left& left) {
  for (const StampedJoints& sample : screenJoints(stream, left)) {
    Observation observation;
    observation.stamp = sample.stamp;
    observation.kind = kind;
    observation.joints = sample.positions;
    motion.observations.push_back(std::move(observation));
  }
}

void addEncoders(const Trajectory& trajectory, const KinematicChain& robot, PoseTracker& tracker,
                 Recording::Motion& motion, Recording::Left& left) {
  if (trajectory.joint_observations.names == robot.jointNames()) {
    addJointObservations(trajectory.joint_observations, Observation::Kind::kEncoders, motion, left);
    return;
  }
  const ScreenedStream screened = screenObservations(trajectory.encoders);
  left.observations += trajectory.encoders.size();
  left.repeated += trajectory.encoders.size() - screened.samples.size();
  for (const StampedPose& sample : screened.samples) {
    Observation observation;
    observation.stamp = sample.stamp;
    observation.kind = Observation::Kind::kEncoders;
    if (tracker.follow(sample.pose, observation.joints))
      motion.observations.push_back(std::move(observation));
    else
      ++left.impossible;
  }
}

void addObservedPoses(const PoseStream& stream, double max_speed, Recording::Motion& motion,
                      Recording::Left& left) {
  const ScreenedStream screened = screenObservations(stream);
  left.observations += stream.size();
  for (const Fate fate : screened.fate) {
    if (fate == Fate::kRepeated) ++left.repeated;
    if (fate == Fate::kNotFinite || fate == Fate::kNotUnit) ++left.impossible;
  }
  for (std::size_t i = 0; i < screened.samples.size(); ++i) {
    const StampedPose& sample = screened.samples[i];
    if (i > 0 && max_speed > 0.0) {
      const StampedPose& before = screened.samples[i - 1];
      if ((sample.pose.p - before.pose.p).norm() > max_speed * (sample.stamp - before.stamp)) {
        ++left.impossible;  // one of the two is wrong
        continue;
      }
    }
    Observation observation;
    observation.stamp = sample.stamp;
    observation.pose = sample.pose;
    motion.observations.push_back(std::move(observation));
  }
}

/// Takes out orientations that lie too far from the mean of those that do not.
void applyOrientationWindow(double window, Recording& recording) {
  std::vector<Eigen::Quaterniond> all;
  for (const Recording::Motion& motion : recording.motions)
    for (const Observation& observation : motion.observations)
      if (observation.kind == Observation::Kind::kPose) all.push_back(observation.pose.q);
  if (all.empty()) return;
  std::vector<Eigen::Quaterniond> inside = all;
  Eigen::Quaterniond mean = meanRotation(all);
  for (int round = 0; round < kMeanRounds; ++round) {
    inside.clear();
    for (const Eigen::Quaterniond& q : all)
      if (rotationAngle(mean, q) <= window) inside.push_back(q);
    if (inside.empty()) return;  // no common orientation: nothing to compare with
    mean = meanRotation(inside);
  }
  if (static_cast<double>(inside.size()) < (1.0 - kMostWrong) * static_cast<double>(all.size()))
    return;  // so many cannot be wrong: the tool does turn that far
  for (Recording::Motion& motion : recording.motions) {
    auto& samples = motion.observations;
    const auto outside = [&](const Observation& observation) {
      return observation.kind == Observation::Kind::kPose &&
             rotationAngle(mean, observation.pose.q) > window;
    };
    const auto end = std::remove_if(samples.begin(), samples.end(), outside);
    recording.left_out.impossible += static_cast<std::size_t>(samples.end() - end);
    samples.erase(end, samples.end());
  }
}

/// Remembers about `runs` runs of three consecutive frames of each kind, evenly spread over all
/// motions; all frames where there are not more.
void rememberFrames(std::size_t runs, Recording& recording) {
  for (const auto kind :
       {Observation::Kind::kPose, Observation::Kind::kJoints, Observation::Kind::kEncoders}) {
    const auto ofKind = [kind](const Recording::Motion& motion) {
      std::vector<const Observation*> frames;
      for (const Observation& observation : motion.observations)
        if (observation.kind == kind) frames.push_back(&observation);
      return frames;
    };
    std::size_t total = 0;
    for (const Recording::Motion& motion : recording.motions) total += ofKind(motion).size();
    const std::size_t stride = std::max<std::size_t>(3, total / runs);  // frames for one run
    for (Recording::Motion& motion : recording.motions) {
      const std::vector<const Observation*> frames = ofKind(motion);
      const std::size_t here = std::max<std::size_t>(1, frames.size() / stride);
      for (std::size_t run = 0; run < here; ++run) {
        // The middle three of its part; where the parts have no more than three, all of them.
        const std::size_t begin = run * frames.size() / here;
        const std::size_t end = (run + 1) * frames.size() / here;
        const std::size_t length = stride > 3 ? std::min<std::size_t>(3, end - begin) : end - begin;
        const std::size_t first = begin + (end - begin - length) / 2;
        for (std::size_t i = first; i < first + length; ++i) motion.frames.push_back(*frames[i]);
      }
    }
  }
  for (Recording::Motion& motion : recording.motions)
    std::stable_sort(motion.frames.begin(), motion.frames.end(),
                     [](const Observation& a, const Observation& b) { return a.stamp < b.stamp; });
}

/// Keeps every n-th observation of each kind, so that about `most` of all remain; one of a motion
/// at least. Of a sparse kind, of which nothing is kept in a motion, more is due in the next one.
void thin(std::size_t most, Recording& recording) {
  std::size_t total = 0;
  for (const Recording::Motion& motion : recording.motions) total += motion.observations.size();
  if (most == 0 || total <= most) return;
  const double keep = static_cast<double>(most) / static_cast<double>(total);
  double share[3] = {0.5, 0.5, 0.5};
  for (Recording::Motion& motion : recording.motions) {
    bool any[3] = {false, false, false};
    std::vector<Observation> kept;
    for (Observation& observation : motion.observations) {
      const int kind = static_cast<int>(observation.kind);
      share[kind] += keep;
      if (share[kind] < 1.0) continue;
      share[kind] -= 1.0;
      any[kind] = true;
      kept.push_back(std::move(observation));
    }
    if (kept.empty() && !motion.observations.empty())  // no motion goes altogether
      kept.push_back(std::move(motion.observations[motion.observations.size() / 2]));
    recording.left_out.thinned += motion.observations.size() - kept.size();
    motion.observations = std::move(kept);
    for (int kind = 0; kind < 3; ++kind)
      if (any[kind]) share[kind] = 0.5;
  }
}

/// One simulation runs through the whole recording, with one homing and one registration.
void refuseSeveralSessions(const Dataset& dataset) {
  const std::vector<std::size_t> starts = sessionStarts(dataset);
  if (starts.size() < 2) return;
  const Trajectory& next = dataset.trajectories[starts[1]];
  const Trajectory& before = dataset.trajectories[starts[1] - 1];
  throw InvalidInput(format(
      "%s: %zu sessions: between trajectory %s and trajectory %s there are %.1f h, at most %.0f h "
      "are within one session; between sessions a robot is homed and registered anew, so diagnose "
      "each on its own",
      dataset.source.empty() ? dataset.name.c_str() : dataset.source.c_str(), starts.size(),
      before.id.c_str(), next.id.c_str(), (next.start() - before.end()) / 3600.0,
      kLongestPause / 3600.0));
}

/// Motions that can say something, in order of time; the rest is dropped.
void finish(const Dataset& dataset, const RecordingOptions& options, Recording& recording) {
  applyOrientationWindow(options.orientation_window, recording);
  const auto useless = [](const Recording::Motion& motion) {
    return motion.setpoints.empty() || motion.observations.empty();
  };
  auto& motions = recording.motions;
  motions.erase(std::remove_if(motions.begin(), motions.end(), useless), motions.end());
  if (motions.empty())
    throw InvalidInput(
        format("%s: nothing to diagnose: of %zu trajectories none has both %s that the robot can "
               "reach and observations (%zu poses out of reach, %zu observations impossible); "
               "check the robot of the simulation file, units and frames",
               dataset.source.c_str(), dataset.trajectories.size(),
               recording.source == DriveSource::kCommands ? "commands" : "encoder samples",
               recording.left_out.unreachable, recording.left_out.impossible));
  const Recording::Left& left = recording.left_out;
  if (2 * left.outside_limits > left.setpoints)
    throw InvalidInput(format(
        "%s: %zu of %zu commands are outside the joint limits of %s; is it the simulation file "
        "of another robot or arm, are positions in millimetres?",
        dataset.source.empty() ? dataset.name.c_str() : dataset.source.c_str(), left.outside_limits,
        left.setpoints, recording.robot.name().c_str()));
  for (Recording::Motion& motion : motions)
    std::stable_sort(motion.observations.begin(), motion.observations.end(),
                     [](const Observation& a, const Observation& b) { return a.stamp < b.stamp; });
  for (const Recording::Motion& motion : motions)  // also those that thinning leaves out
    for (const Observation& observation : motion.observations)
      recording.has_encoders |= observation.kind == Observation::Kind::kEncoders;
  rememberFrames(kNoiseRuns, recording);
  thin(options.max_samples, recording);
}

/// A chain of joints without any geometry, for data that has none.
KinematicChain jointsOnly(const Dataset& dataset, const std::vector<std::string>& names,
                          const std::vector<bool>& prismatic) {
  if (names.size() > static_cast<std::size_t>(kMaxJoints) || names.size() != prismatic.size())
    throw InvalidInput(format("%s: %zu joints with %zu kinds, at most %d joints can be diagnosed",
                              dataset.source.c_str(), names.size(), prismatic.size(), kMaxJoints));
  std::vector<Joint> joints(names.size());
  for (std::size_t j = 0; j < names.size(); ++j) {
    std::vector<double> values;
    for (const Trajectory& trajectory : dataset.trajectories)
      for (const StampedJoints& sample : trajectory.joint_commands.samples)
        values.push_back(sample.positions(static_cast<Eigen::Index>(j)));
    joints[j].name = names[j];
    joints[j].type = prismatic[j] ? JointType::kPrismatic : JointType::kRevolute;
    joints[j].home = values.empty() ? 0.0 : median(values);
    const auto [low, high] = std::minmax_element(values.begin(), values.end());
    joints[j].lower = values.empty() ? -1.0 : *low - 1.0;
    joints[j].upper = values.empty() ? 1.0 : *high + 1.0;
  }
  return KinematicChain(dataset.arm.empty() ? "joints" : dataset.arm, dataset.frame, Pose(), joints,
                        Pose());
}

}  // namespace

bool isJointData(const Dataset& dataset) noexcept {
  bool joints = false;
  for (const Trajectory& trajectory : dataset.trajectories) {
    if (!trajectory.commands.empty() || !trajectory.observations.empty()) return false;
    joints |= !trajectory.joint_commands.samples.empty();
  }
  return joints;
}

Recording makeRecording(const Dataset& dataset, const KinematicChain& robot,
                        const RecordingOptions& options) {
  if (dataset.frame != robot.frame())
    throw InvalidInput(format(
        "%s: its poses are in frame \"%s\", the robot %s of the simulation file is described "
        "in \"%s\"; use the simulation of this robot and frame",
        dataset.source.c_str(), dataset.frame.c_str(), robot.name().c_str(),
        robot.frame().c_str()));
  refuseSeveralSessions(dataset);
  Recording recording;
  recording.name = dataset.name;
  recording.source = options.source;
  recording.robot = robot;
  PoseTracker commands(robot), encoders(robot);
  for (const Trajectory& trajectory : dataset.trajectories) {
    Recording::Motion motion;
    motion.id = trajectory.id;
    if (options.source == DriveSource::kCommands) {
      addPoseSetpoints(trajectory.commands, true, robot, commands, motion, recording.left_out);
      if (options.use_encoders)
        addEncoders(trajectory, robot, encoders, motion, recording.left_out);
    } else if (trajectory.joint_observations.names == robot.jointNames()) {
      Recording::Left ignored;
      for (const StampedJoints& sample : screenJoints(trajectory.joint_observations, ignored))
        motion.setpoints.push_back({sample.stamp, sample.positions});
      recording.left_out.setpoints += ignored.observations;
    } else {
      addPoseSetpoints(trajectory.encoders, false, robot, encoders, motion, recording.left_out);
    }
    addObservedPoses(trajectory.observations, options.max_speed, motion, recording.left_out);
    recording.motions.push_back(std::move(motion));
  }
  finish(dataset, options, recording);
  return recording;
}

Recording makeJointRecording(const Dataset& dataset, const std::vector<bool>& prismatic,
                             const RecordingOptions& options) {
  std::vector<std::string> names;
  for (const Trajectory& trajectory : dataset.trajectories) {
    const std::vector<std::string>& here = trajectory.joint_commands.names;
    if (trajectory.joint_commands.samples.empty()) continue;
    if (names.empty()) names = here;
    if (here != names || trajectory.joint_observations.names != names)
      throw InvalidInput(format(
          "%s: trajectory %s: commands and observations must name the same joints in the same "
          "order throughout",
          dataset.source.c_str(), trajectory.id.c_str()));
  }
  refuseSeveralSessions(dataset);
  Recording recording;
  recording.name = dataset.name;
  recording.robot = jointsOnly(dataset, names, prismatic);
  recording.has_kinematics = false;
  for (const Trajectory& trajectory : dataset.trajectories) {
    Recording::Motion motion;
    motion.id = trajectory.id;
    for (const StampedJoints& sample : trajectory.joint_commands.samples) {
      ++recording.left_out.setpoints;
      if (std::isfinite(sample.stamp) && sample.positions.allFinite())
        motion.setpoints.push_back({sample.stamp, sample.positions});
      else
        ++recording.left_out.not_a_command;
    }
    addJointObservations(trajectory.joint_observations, Observation::Kind::kJoints, motion,
                         recording.left_out);
    recording.motions.push_back(std::move(motion));
  }
  finish(dataset, options, recording);
  return recording;
}

}  // namespace raven_correction
