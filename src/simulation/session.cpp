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
constexpr std::uint64_t kSeedsPerArm = 2;  // motions, motion capture

bool isCommand(const StampedPose& command) {
  return isFinite(command.pose) && hasUnitQuaternion(command.pose) && !isIdentity(command.pose);
}

/// What an arm is told in a debridement session.
struct Plan {
  Pose start;  // it rests here
  std::vector<DebridementTrajectory> motions;
};

Plan planSession(const SimulationConfig& config, int trajectories, std::uint64_t seed) {
  DebridementMotion motion(config.debridement, config.robot, seed);
  Plan plan{motion.rest(), {}};
  double start = kStart + kSettle;
  for (int i = 0; i < trajectories; ++i) {
    plan.motions.push_back(motion.next(start));
    start = plan.motions.back().commands.back().stamp + kBetween;
  }
  return plan;
}

/// Another arm in the room of the one that is recorded. Arms move independently, so a copy of it
/// that follows its own commands knows where its instrument is at any instant.
class Neighbour {
 public:
  Neighbour(const SimulationConfig& config, const Plan& plan)
      : rig_(config.motion_capture.rig), arm_(config) {
    for (const DebridementTrajectory& motion : plan.motions) {
      commands_.insert(commands_.end(), motion.commands.begin(), motion.commands.end());
      jaw_.insert(jaw_.end(), motion.jaw.begin(), motion.jaw.end());
    }
    arm_.reset(kStart, plan.start);
    arm_.startSession(kStart + kSettle);
  }
  /// @param time  never decreasing [s]
  Obstacle instrumentAt(double time) {
    for (; next_ < commands_.size() && commands_[next_].stamp <= time; ++next_) {
      arm_.command(commands_[next_]);
      arm_.commandJaw(commands_[next_].stamp, jaw_[next_]);
    }
    arm_.advanceTo(time);
    return instrumentOf(rig_, arm_.toolPose());
  }

 private:
  CameraRigConfig rig_;
  SimulatedArm arm_;
  PoseStream commands_;
  std::vector<double> jaw_;  // one per command
  std::size_t next_ = 0;
};

/// Drives the arm through one trajectory and records it from its first to its last command.
class Recorder {
 public:
  Recorder(const SimulationConfig& config, std::uint64_t seed,
           std::vector<Neighbour> neighbours = {})
      : config_(config),
        arm_(config),
        mocap_(config.motion_capture, seed),
        neighbours_(std::move(neighbours)) {}

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
        const MocapFrame frame = mocap_.capture(arm_.toolPose(), obstaclesAt(now));
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
    mocap_.capture(arm_.toolPose(), obstaclesAt(mocap_.nextExposure()));
  }
  std::vector<Obstacle> obstaclesAt(double time) {
    std::vector<Obstacle> obstacles;
    for (Neighbour& neighbour : neighbours_) obstacles.push_back(neighbour.instrumentAt(time));
    return obstacles;
  }

  const SimulationConfig& config_;
  SimulatedArm arm_;
  MotionCapture mocap_;
  std::vector<Neighbour> neighbours_;
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

Dataset recordPlan(const SimulationConfig& config, const Plan& plan,
                   std::vector<Neighbour> neighbours, std::uint64_t seed) {
  Recorder recorder(config, seed + 1, std::move(neighbours));
  recorder.startAt(kStart);
  recorder.arm().reset(kStart, plan.start);
  recorder.arm().startSession(kStart + kSettle);
  Dataset dataset = describe(config, "simulated debridement session", seed);
  for (std::size_t i = 0; i < plan.motions.size(); ++i) {
    Trajectory trajectory;
    trajectory.id = format("t%03zu", i);
    trajectory.commands = plan.motions[i].commands;
    recorder.record(trajectory, plan.motions[i].jaw);
    dataset.trajectories.push_back(std::move(trajectory));
  }
  return dataset;
}

}  // namespace

Dataset simulateSession(const SimulationConfig& config, int trajectories, std::uint64_t seed) {
  return simulateSessions({config}, trajectories, seed).front();
}

std::vector<Dataset> simulateSessions(const std::vector<SimulationConfig>& configs,
                                      int trajectories, std::uint64_t seed) {
  if (trajectories <= 0)
    throw InvalidInput(format("%d trajectories to simulate, must be > 0", trajectories));
  std::vector<Plan> plans;
  for (std::size_t i = 0; i < configs.size(); ++i)
    plans.push_back(planSession(configs[i], trajectories, seed + kSeedsPerArm * i));
  std::vector<Dataset> datasets;
  for (std::size_t i = 0; i < configs.size(); ++i) {
    std::vector<Neighbour> neighbours;
    for (std::size_t k = 0; k < configs.size(); ++k)
      if (k != i && configs[k].robot.frame() == configs[i].robot.frame())
        neighbours.emplace_back(configs[k], plans[k]);
    datasets.push_back(
        recordPlan(configs[i], plans[i], std::move(neighbours), seed + kSeedsPerArm * i));
  }
  return datasets;
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
    if (number == 0) {
      recorder.arm().reset(kStart, planned.commands.front().pose);
      recorder.arm().startSession(start);
    }
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
      recorder.arm().startSession(begin);
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
