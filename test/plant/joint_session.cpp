// SPDX-License-Identifier: BSD-3-Clause
#include "plant/joint_session.h"

#include <algorithm>
#include <cmath>
#include <random>

#include "plant/draw.h"
#include "plant/recorder.h"
#include "raven_correction/error.h"

namespace raven_correction::plant {
namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr double kStopPeriod = 0.4;  // [s]
constexpr int kPrismatic = 2;        // q3

double noiseOf(int joint, double noise) { return joint == kPrismatic ? 0.1 * noise : noise; }

/// Six joints that are somewhere, but nobody knows where: no geometry, no mass, home 0.
KinematicChain anonymousJoints() {
  std::vector<Joint> joints;
  for (int j = 0; j < 6; ++j) {
    Joint joint;
    joint.name = format("q%d", j + 1);
    joint.type = j == kPrismatic ? JointType::kPrismatic : JointType::kRevolute;
    joint.lower = -3.0;
    joint.upper = 3.0;
    joints.push_back(joint);
  }
  return KinematicChain("joints", "joint_space", Pose(), std::move(joints), Pose());
}

JointVector amplitudes() {
  JointVector amplitude(6);
  amplitude << 0.5, 0.4, 0.05, 1.0, 0.8, 0.8;
  return amplitude;
}

struct Scene {
  KinematicChain robot = anonymousJoints();
  Motion motion;

  explicit Scene(const JointSessionOptions& options) {
    MotionOptions plan;
    plan.trajectories = options.trajectories;
    plan.rate = options.stops ? 1.0 / kStopPeriod : options.command_rate;
    plan.stamp_jitter = options.stops ? 0.05 : 1e-3;
    plan.start = options.start;
    plan.seed = options.seed;
    motion = planJointMotion(amplitudes(), options.stops, plan);
  }
  RobotPhysics with(const std::vector<HiddenEffect>& hidden) const {
    const std::vector<std::string>& known = jointSessionEffects();
    RobotPhysics physics = cleanRobot(robot);
    for (const HiddenEffect& effect : hidden) {
      if (std::find(known.begin(), known.end(), effect.effect) == known.end())
        throw InvalidInput("joints alone cannot show " + effect.effect);
      applyEffect(effect, physics);
    }
    return physics;
  }
};

/// Joints at each instant of observation, without noise.
std::vector<std::vector<StampedJoints>> run(const Scene& scene, const RobotPhysics& physics,
                                            const JointSessionOptions& options) {
  std::vector<std::vector<StampedJoints>> seen;
  if (!options.stops) {
    RecorderOptions recorder;
    recorder.frame_rate = options.observation_rate;
    recorder.seed = options.seed;
    for (RecordedTrajectory& trajectory : record(physics, scene.motion, recorder).trajectories)
      seen.push_back(std::move(trajectory.joints));
    return seen;
  }
  // Both streams carry the stamp at which the stop was looked at; the command was sent before.
  RobotPlant plant(physics, scene.motion.approach, scene.motion.start() - 2.0 * kStopPeriod,
                   scene.motion.start());
  for (const PlannedTrajectory& trajectory : scene.motion.trajectories) {
    seen.emplace_back();
    for (std::size_t k = 0; k < trajectory.commands.size(); ++k) {
      const double stamp = trajectory.commands[k].stamp;
      plant.command(stamp - 0.7 * kStopPeriod, trajectory.joints[k]);
      plant.advanceTo(stamp);
      seen.back().push_back({stamp, Eigen::VectorXd(plant.joints())});
    }
  }
  return seen;
}

/// The joint that moves most in multiples of its noise.
struct JointSize {
  double multiples = 0.0;
  double mm = 0.0;
  double deg = 0.0;
};

JointSize difference(const std::vector<std::vector<StampedJoints>>& a,
                     const std::vector<std::vector<StampedJoints>>& b, double noise) {
  JointVector squared = JointVector::Zero(6);
  double count = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    for (std::size_t k = 0; k < a[i].size(); ++k) {
      squared += (a[i][k].positions - b[i][k].positions).cwiseAbs2();
      count += 1.0;
    }
  }
  JointSize size;
  for (int j = 0; j < 6; ++j) {
    const double rms = std::sqrt(squared(j) / std::max(1.0, count));
    size.multiples = std::max(size.multiples, rms / noiseOf(j, noise));
    if (j == kPrismatic)
      size.mm = 1e3 * rms;
    else
      size.deg = std::max(size.deg, 180.0 / kPi * rms);
  }
  return size;
}

Dataset datasetOf(const Scene& scene, const std::vector<std::vector<StampedJoints>>& seen,
                  double noise, std::uint64_t seed) {
  std::mt19937_64 random(seed ^ 0x2545f4914f6cdd1dULL);
  std::normal_distribution<double> normal;
  Dataset dataset;
  dataset.name = "plant_joints";
  dataset.description =
      format("joints of the test plant, seed %llu", static_cast<unsigned long long>(seed));
  dataset.frame = scene.robot.frame();
  dataset.arm = scene.robot.name();
  for (std::size_t i = 0; i < seen.size(); ++i) {
    Trajectory trajectory;
    trajectory.id = scene.motion.trajectories[i].id;
    trajectory.joint_commands = jointCommands(scene.robot, scene.motion.trajectories[i]);
    trajectory.joint_observations = {scene.robot.jointNames(), seen[i]};
    for (StampedJoints& sample : trajectory.joint_observations.samples)
      for (int j = 0; j < 6; ++j) sample.positions(j) += noiseOf(j, noise) * normal(random);
    dataset.trajectories.push_back(std::move(trajectory));
  }
  return dataset;
}

}  // namespace

const std::vector<std::string>& jointSessionEffects() {
  static const std::vector<std::string> names{
      "command_delay", "tracking_lag",   "drive_friction", "speed_limit",         "joint_offset",
      "joint_gain",    "joint_coupling", "backlash",       "pulley_eccentricity", "creep"};
  return names;
}

PlantSession recordJointsClean(const JointSessionOptions& options) {
  return recordJointsHidden(options, {});
}

PlantSession recordJointsHidden(const JointSessionOptions& options,
                                const std::vector<HiddenEffect>& hidden) {
  const Scene scene(options);
  const auto seen = run(scene, scene.with(hidden), options);
  PlantSession session;
  session.dataset = datasetOf(scene, seen, options.noise, options.seed);
  session.noise_free = datasetOf(scene, seen, 0.0, options.seed);
  session.truth = hidden;
  if (hidden.empty()) return session;
  const auto clean = run(scene, scene.with({}), options);
  for (HiddenEffect& effect : session.truth) {
    const JointSize size =
        difference(clean, hidden.size() == 1 ? seen : run(scene, scene.with({effect}), options),
                   options.noise);
    effect.size_mm = size.mm;
    effect.size_deg = size.deg;
  }
  return session;
}

HiddenEffect drawJointsHidden(const JointSessionOptions& options, const std::string& effect,
                              std::uint64_t seed, double smallest, double largest) {
  const Scene scene(options);
  std::mt19937_64 random = randomFor(effect, seed);
  const HiddenEffect shape = drawShape(effect, scene.robot, scene.motion, random);
  const double size = std::exp(
      std::uniform_real_distribution<double>(std::log(smallest), std::log(largest))(random));
  const auto clean = run(scene, scene.with({}), options);
  const auto measure = [&](const HiddenEffect& trial) {
    return difference(clean, run(scene, scene.with({trial}), options), options.noise).multiples;
  };
  return scaledBy(measure, shape, scene.robot, size);
}

}  // namespace raven_correction::plant
