// SPDX-License-Identifier: BSD-3-Clause
#include "raven_correction/simulation/session.h"

#include <algorithm>
#include <cmath>

#include "raven_correction/error.h"
#include "raven_correction/simulation/simulated_arm.h"

namespace raven_correction {
namespace {

constexpr double kStart = 1000.0;    // stamp of a session's first command; 0 would mean "invalid"
constexpr double kBetween = 0.3;     // pause between two trajectories [s]
constexpr double kSettle = 1.0;      // before the first command [s]
constexpr double kSamePlace = 0.03;  // a recording that starts so near began a little late [m]

bool isCommand(const StampedPose& command) {
  return isFinite(command.pose) && hasUnitQuaternion(command.pose) && !isIdentity(command.pose);
}

/// Drives the arm through one trajectory and records it from its first to its last command.
class Recorder {
 public:
  Recorder(const SimulationConfig& config, std::uint64_t seed)
      : config_(config), arm_(config), mocap_(config.motion_capture, seed) {}

  SimulatedArm& arm() { return arm_; }

  /// @param jaw  opening with each command, or empty [rad]
  void record(Trajectory& trajectory, const std::vector<double>& jaw = {}) {
    const PoseStream& commands = trajectory.commands;
    const double first = commands.front().stamp;
    const double last = commands.back().stamp;
    trajectory.joint_commands.names = config_.robot.jointNames();
    trajectory.joint_observations.names = config_.robot.jointNames();
    std::size_t next = 0;
    // Frames of the cameras and samples of the encoders run on through the pauses.
    while (mocap_.nextExposure() < first) skipFrames(first);
    while (next_encoder_ < first) next_encoder_ += 1.0 / config_.encoder_rate;
    for (;;) {
      const double now = std::min(mocap_.nextExposure(), next_encoder_);
      for (; next < commands.size() && commands[next].stamp <= now; ++next) {
        take(commands[next], trajectory);
        if (!jaw.empty()) arm_.commandJaw(commands[next].stamp, jaw[next]);
      }
      if (now > last) break;
      arm_.advanceTo(now);
      if (now == next_encoder_) {
        trajectory.encoders.push_back({now, arm_.measuredPose()});
        trajectory.joint_observations.samples.push_back({now, arm_.encoderJoints()});
        next_encoder_ += 1.0 / config_.encoder_rate;
      }
      if (now == mocap_.nextExposure()) {
        const MocapFrame frame = mocap_.capture(arm_.toolPose());
        if (frame.pose && frame.pose->stamp >= first)  // a repeated one may be older
          trajectory.observations.push_back(*frame.pose);
      }
    }
    arm_.advanceTo(last);
  }

  void startAt(double time) {
    mocap_.restart(time);
    next_encoder_ = time;
  }

 private:
  void take(const StampedPose& command, Trajectory& trajectory) {
    if (!isCommand(command)) return;
    if (reproducesPose(arm_.command(command)))
      trajectory.joint_commands.samples.push_back({command.stamp, arm_.state().command_joints});
  }
  void skipFrames(double until) {
    arm_.advanceTo(std::min(mocap_.nextExposure(), until));
    mocap_.capture(arm_.toolPose());
  }

  const SimulationConfig& config_;
  SimulatedArm arm_;
  MotionCapture mocap_;
  double next_encoder_ = 0.0;
};

Dataset describe(const SimulationConfig& config, const char* what, std::uint64_t seed) {
  Dataset dataset;
  dataset.name = config.name;
  dataset.description = format("%s, seed %llu; %s", what, static_cast<unsigned long long>(seed),
                               config.description.c_str());
  dataset.frame = config.robot.frame();
  dataset.arm = config.robot.name();
  return dataset;
}

}  // namespace

Dataset simulateSession(const SimulationConfig& config, int trajectories, std::uint64_t seed) {
  if (trajectories <= 0)
    throw InvalidInput(format("%d trajectories to simulate, must be > 0", trajectories));
  DebridementMotion motion(config.debridement, config.robot, seed);
  Recorder recorder(config, seed + 1);
  recorder.startAt(kStart);
  recorder.arm().reset(kStart, motion.rest());
  Dataset dataset = describe(config, "simulated debridement session", seed);
  double start = kStart + kSettle;
  for (int i = 0; i < trajectories; ++i) {
    const DebridementTrajectory planned = motion.next(start);
    Trajectory trajectory;
    trajectory.id = format("t%03d", i);
    trajectory.commands = planned.commands;
    recorder.record(trajectory, planned.jaw);
    start = trajectory.commands.back().stamp + kBetween;
    dataset.trajectories.push_back(std::move(trajectory));
  }
  return dataset;
}

Dataset simulateExcitation(const SimulationConfig& config, const ExcitationConfig& excitation,
                           std::uint64_t seed) {
  Recorder recorder(config, seed + 1);
  recorder.startAt(kStart);
  Dataset dataset = describe(config, "simulated excitation session", seed);
  const double start = kStart + kSettle;
  int number = 0;
  for (ExcitationTrajectory& planned :
       excitationMotions(excitation, config.debridement, config.robot, start, seed)) {
    if (number == 0) recorder.arm().reset(kStart, planned.commands.front().pose);
    Trajectory trajectory;
    trajectory.id = format("t%03d_%s", number++, planned.label.c_str());
    trajectory.commands = std::move(planned.commands);
    recorder.record(trajectory);
    dataset.trajectories.push_back(std::move(trajectory));
  }
  return dataset;
}

Dataset simulateCommands(const SimulationConfig& config, const Dataset& measured,
                         std::uint64_t seed) {
  if (measured.trajectories.empty()) throw InvalidInput("no trajectory to simulate");
  Recorder recorder(config, seed);
  Dataset dataset;
  dataset.name = measured.name + "_simulated";
  dataset.description = "commands of " + measured.name + ", driven through " + config.name;
  dataset.frame = measured.frame;
  dataset.arm = measured.arm;
  bool first = true;
  Pose last;
  for (const Trajectory& source : measured.trajectories) {
    const auto start = std::find_if(source.commands.begin(), source.commands.end(), isCommand);
    if (start == source.commands.end())
      throw InvalidInput("trajectory " + source.id + " has no command that is a pose");
    Trajectory trajectory;
    trajectory.id = source.id;
    trajectory.commands = source.commands;
    const double begin = source.commands.front().stamp;
    if (first || begin < recorder.arm().time()) {
      const IkStatus status = recorder.arm().reset(begin - kSettle, start->pose);
      if (!reproducesPose(status))
        throw InvalidInput("trajectory " + source.id + ": its first pose is " + toString(status) +
                           " for " + config.robot.name());
      recorder.startAt(begin - kSettle);
      first = false;
    } else if ((start->pose.p - last.p).norm() > kSamePlace) {
      // The arm goes to where this recording starts while nobody records.
      recorder.arm().command({recorder.arm().time(), start->pose});
    }
    last = std::find_if(source.commands.rbegin(), source.commands.rend(), isCommand)->pose;
    recorder.record(trajectory);
    dataset.trajectories.push_back(std::move(trajectory));
  }
  return dataset;
}

std::vector<ReplaySample> replay(SimulatedArm& arm, const PoseStream& commands,
                                 const std::vector<double>& instants) {
  const auto start = std::find_if(commands.begin(), commands.end(), isCommand);
  if (start == commands.end()) throw InvalidInput("no command that is a pose");
  const double begin =
      std::min(commands.front().stamp, instants.empty() ? start->stamp : instants[0]);
  const IkStatus status = arm.reset(begin, start->pose);
  if (!reproducesPose(status))
    throw InvalidInput(std::string("the first command is ") + toString(status) + " for " +
                       arm.config().robot.name());
  for (const StampedPose& command : commands)
    if (isCommand(command)) arm.command(command);
  std::vector<ReplaySample> samples;
  samples.reserve(instants.size());
  for (const double instant : instants) {
    arm.advanceTo(instant);
    samples.push_back({arm.toolPose(), arm.measuredPose(), arm.joints(), arm.encoderJoints()});
  }
  return samples;
}

}  // namespace raven_correction
