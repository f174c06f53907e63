// SPDX-License-Identifier: BSD-3-Clause
#include "plant/session.h"

#include <algorithm>
#include <cmath>

#include "plant/draw.h"
#include "plant/recorder.h"
#include "raven_correction/error.h"
#include "raven_correction/robot/chain_file.h"

namespace raven_correction::plant {
namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr double kNoiseMm = 0.1;
constexpr double kNoiseDeg = 0.3;
constexpr double kOrientationPerNoise = 52.36;  // 0.3 deg where positions have 0.1 mm [rad/m]
constexpr int kMostDraws = 20;                  // until a joint shows an effect of this size
constexpr int kShortSession = 16;               // trajectories that are enough to find a size

/// What a session consists of before anything is hidden.
struct Scene {
  KinematicChain robot;
  Motion motion;

  explicit Scene(const PlantOptions& options)
      : robot(loadKinematicChain(options.robot_file)), motion(planMotion(robot, plan(options))) {}

  static MotionOptions plan(const PlantOptions& options) {
    MotionOptions motion;
    motion.trajectories = options.trajectories;
    motion.rate = options.command_rate;
    motion.start = options.start;
    motion.seed = options.seed;
    return motion;
  }
  RobotPhysics clean() const {
    RobotPhysics physics = cleanRobot(robot);
    physics.volume_middle = motion.middle;
    return physics;
  }
  RobotPhysics with(const std::vector<HiddenEffect>& hidden) const {
    RobotPhysics physics = clean();
    for (const HiddenEffect& effect : hidden) applyEffect(effect, physics);
    return physics;
  }
};

RecorderOptions recorderOptions(const PlantOptions& options) {
  RecorderOptions recorder;
  recorder.frame_rate = options.frame_rate;
  recorder.seed = options.seed;
  return recorder;
}

Recording run(const Scene& scene, const RobotPhysics& physics, const PlantOptions& options) {
  return record(physics, scene.motion, recorderOptions(options));
}

ToolSize difference(const Recording& a, const Recording& b) {
  double squared_length = 0.0;
  double squared_angle = 0.0;
  std::size_t count = 0;
  for (std::size_t i = 0; i < a.trajectories.size(); ++i) {
    const PoseStream& seen = a.trajectories[i].observed;
    for (std::size_t k = 0; k < seen.size(); ++k) {
      const Pose& other = b.trajectories[i].observed[k].pose;
      squared_length += (seen[k].pose.p - other.p).squaredNorm();
      squared_angle += std::pow(rotationAngle(seen[k].pose.q, other.q), 2);
      ++count;
    }
  }
  const double n = static_cast<double>(std::max<std::size_t>(count, 1));
  return {1e3 * std::sqrt(squared_length / n), 180.0 / kPi * std::sqrt(squared_angle / n)};
}

Dataset describeSession(const Scene& scene, const PlantOptions& options, const char* what) {
  Dataset dataset;
  dataset.name = "plant";
  dataset.description =
      format("%s, seed %llu", what, static_cast<unsigned long long>(options.seed));
  dataset.frame = scene.robot.frame();
  dataset.arm = scene.robot.name();
  return dataset;
}

Dataset perfectDataset(const Scene& scene, const Recording& recording,
                       const PlantOptions& options) {
  Dataset dataset = describeSession(scene, options, "seen by perfect cameras");
  for (std::size_t i = 0; i < recording.trajectories.size(); ++i) {
    const PlannedTrajectory& planned = scene.motion.trajectories[i];
    const RecordedTrajectory& recorded = recording.trajectories[i];
    Trajectory trajectory;
    trajectory.id = planned.id;
    trajectory.commands = planned.commands;
    trajectory.observations = recorded.observed;
    trajectory.encoders = recorded.motor_poses;
    trajectory.joint_commands = jointCommands(scene.robot, planned);
    trajectory.joint_observations = {scene.robot.jointNames(), recorded.joints};
    dataset.trajectories.push_back(std::move(trajectory));
  }
  return dataset;
}

Dataset seenDataset(const Scene& scene, const Recording& recording, const PlantOptions& options) {
  CameraOptions cameras;
  cameras.noise = options.noise;
  cameras.orientation_noise = kOrientationPerNoise * options.noise;
  if (!options.dirt) cameras = cleanCameras(cameras.noise, cameras.orientation_noise);
  Dataset dataset = describeSession(scene, options, "session of the test plant");
  for (std::size_t i = 0; i < recording.trajectories.size(); ++i) {
    const PlannedTrajectory& planned = scene.motion.trajectories[i];
    const RecordedTrajectory& recorded = recording.trajectories[i];
    Trajectory trajectory;
    trajectory.id = planned.id;
    trajectory.commands = planned.commands;
    trajectory.observations = photograph(recorded.observed, cameras, options.seed * 1000003 + i);
    if (options.encoders) {
      trajectory.joint_commands = jointCommands(scene.robot, planned);
      trajectory.joint_observations = {scene.robot.jointNames(), recorded.encoders};
      for (const StampedJoints& sample : recorded.encoders)
        trajectory.encoders.push_back({sample.stamp, scene.robot.forward(sample.positions)});
    }
    dataset.trajectories.push_back(std::move(trajectory));
  }
  return dataset;
}

PlantSession sessionOf(const Scene& scene, const Recording& recording,
                       const PlantOptions& options) {
  PlantSession session;
  session.dataset = seenDataset(scene, recording, options);
  session.noise_free = perfectDataset(scene, recording, options);
  return session;
}

PlantOptions shortened(const PlantOptions& options) {
  PlantOptions result = options;
  result.trajectories = std::min(options.trajectories, kShortSession);
  return result;
}

double logUniform(std::mt19937_64& random, double smallest, double largest) {
  return std::exp(
      std::uniform_real_distribution<double>(std::log(smallest), std::log(largest))(random));
}

}  // namespace

double multiplesOfNoise(const ToolSize& size) {
  return std::max(size.mm / kNoiseMm, size.deg / kNoiseDeg);
}

PlantSession recordClean(const PlantOptions& options) { return recordHidden(options, {}); }

PlantSession recordHidden(const PlantOptions& options, const std::vector<HiddenEffect>& hidden) {
  const Scene scene(options);
  const Recording together = run(scene, scene.with(hidden), options);
  PlantSession session = sessionOf(scene, together, options);
  session.truth = hidden;
  if (hidden.empty()) return session;
  const Recording clean = run(scene, scene.clean(), options);
  for (HiddenEffect& effect : session.truth) {
    const ToolSize size = difference(
        clean, hidden.size() == 1 ? together : run(scene, scene.with({effect}), options));
    effect.size_mm = size.mm;
    effect.size_deg = size.deg;
  }
  return session;
}

PlantSession recordOutside(const PlantOptions& options, OutsideKind kind, double size,
                           std::uint64_t seed) {
  const Scene scene(options);
  std::mt19937_64 random(seed);
  const int joint = std::uniform_int_distribution<int>(0, scene.robot.size() - 1)(random);
  const Recording clean = run(scene, scene.clean(), options);
  const auto runAt = [&](double amplitude) {
    RobotPhysics physics = scene.clean();
    applyOutside(kind, joint, amplitude, scene.motion.joint_span, scene.motion.joint_middle,
                 physics);
    return run(scene, physics, options);
  };
  // By the ratio of sizes: all kinds grow about in proportion.
  double amplitude = 1.0;
  Recording recording = runAt(amplitude);
  for (int trial = 0; trial < 5; ++trial) {
    const double now = multiplesOfNoise(difference(clean, recording));
    if (std::abs(now / size - 1.0) < 0.1) break;
    amplitude *= std::clamp(size / now, 0.1, 10.0);
    recording = runAt(amplitude);
  }
  PlantSession session = sessionOf(scene, recording, options);
  session.outside = toString(kind);
  if (isJointKind(kind)) session.outside += "[" + scene.robot.jointNames()[joint] + "]";
  const ToolSize reached = difference(clean, recording);
  session.outside_size_mm = reached.mm;
  session.outside_size_deg = reached.deg;
  return session;
}

ToolSize sizeOf(const PlantOptions& options, const std::vector<HiddenEffect>& hidden) {
  const Scene scene(options);
  return difference(run(scene, scene.clean(), options), run(scene, scene.with(hidden), options));
}

HiddenEffect scaledTo(const PlantOptions& options, const HiddenEffect& hidden, double size) {
  // A bump or a creep needs the time, a speed limit the fastest moves of the session.
  const bool takes_whole_session = hidden.effect == "creep" ||
                                   hidden.effect == "registration_shift" ||
                                   hidden.effect == "speed_limit";
  const PlantOptions trial = takes_whole_session ? options : shortened(options);
  const Scene scene(trial);
  const Recording clean = run(scene, scene.clean(), trial);
  const auto measure = [&](const HiddenEffect& effect) {
    return multiplesOfNoise(difference(clean, run(scene, scene.with({effect}), trial)));
  };
  HiddenEffect result = scaledBy(measure, hidden, scene.robot, size);
  const ToolSize reached = difference(clean, run(scene, scene.with({result}), trial));
  result.size_mm = reached.mm;
  result.size_deg = reached.deg;
  return result;
}

HiddenEffect drawHidden(const PlantOptions& options, const std::string& effect, std::uint64_t seed,
                        double smallest, double largest) {
  std::mt19937_64 random = randomFor(effect, seed);
  const Scene scene(options);
  HiddenEffect hidden;
  for (int attempt = 0; attempt < kMostDraws; ++attempt) {
    const HiddenEffect shape = drawShape(effect, scene.robot, scene.motion, random);
    hidden = scaledTo(options, shape, logUniform(random, smallest, largest));
    if (multiplesOfNoise({hidden.size_mm, hidden.size_deg}) >= 0.9 * smallest) return hidden;
  }
  throw InvalidInput(format("no plausible %s is %g times the noise large: the last was %s",
                            effect.c_str(), smallest, describe(hidden).c_str()));
}

HiddenEffect drawHidden(const PlantOptions& options, std::uint64_t seed, double smallest,
                        double largest) {
  return drawHiddenSet(options, seed, 1, smallest, largest).front();
}

std::vector<HiddenEffect> drawHiddenSet(const PlantOptions& options, std::uint64_t seed, int count,
                                        double smallest, double largest) {
  std::vector<std::string> names = hiddenEffects();
  if (count < 1 || count > static_cast<int>(names.size()))
    throw InvalidInput(format("%d hidden effects at once, must be 1..%zu", count, names.size()));
  std::mt19937_64 random(seed);
  std::shuffle(names.begin(), names.end(), random);
  std::vector<HiddenEffect> hidden;
  for (int k = 0; k < count; ++k)
    hidden.push_back(
        drawHidden(options, names[static_cast<std::size_t>(k)], random(), smallest, largest));
  return hidden;
}

}  // namespace raven_correction::plant
