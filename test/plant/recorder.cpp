// SPDX-License-Identifier: BSD-3-Clause
#include "plant/recorder.h"

#include <algorithm>
#include <cmath>
#include <random>

namespace raven_correction::plant {
namespace {

constexpr double kApproachTime = 2.0;  // [s]
constexpr double kSettleTime = 1.0;    // between approach and first trajectory [s]
constexpr int kApproachSteps = 120;
constexpr double kCount = 2e-5;        // of an encoder, in a revolute joint [rad]
constexpr double kCountLength = 1e-6;  // of an encoder, in a prismatic joint [m]

/// Instants of an even grid inside [from, to].
std::vector<double> instants(double phase, double rate, double from, double to) {
  std::vector<double> result;
  for (double k = std::ceil((from - phase) * rate); phase + k / rate <= to; k += 1.0)
    if (phase + k / rate >= from) result.push_back(phase + k / rate);
  return result;
}

JointVector wholeCounts(const KinematicChain& robot, const JointVector& m) {
  JointVector rounded = m;
  for (int j = 0; j < robot.size(); ++j) {
    const bool revolute = robot.joints()[static_cast<std::size_t>(j)].type == JointType::kRevolute;
    const double count = revolute ? kCount : kCountLength;
    rounded(j) = count * std::round(m(j) / count);
  }
  return rounded;
}

void approach(const Motion& motion, RobotPlant& plant) {
  const JointVector& to = motion.trajectories.front().joints.front();
  for (int k = 1; k <= kApproachSteps; ++k) {
    const double share = k / static_cast<double>(kApproachSteps);
    const double smooth = share * share * (3.0 - 2.0 * share);
    plant.command(motion.start() - kSettleTime - kApproachTime * (1.0 - share),
                  motion.approach + smooth * (to - motion.approach));
  }
}

RecordedTrajectory follow(const PlannedTrajectory& planned, const RobotPhysics& physics,
                          double exposure_phase, double encoder_phase,
                          const RecorderOptions& options, RobotPlant& plant) {
  for (std::size_t k = 0; k < planned.commands.size(); ++k)
    plant.command(planned.commands[k].stamp, planned.joints[k]);
  const double first = planned.commands.front().stamp;
  const double last = planned.commands.back().stamp;
  const std::vector<double> exposures = instants(exposure_phase, options.frame_rate, first, last);
  const std::vector<double> readings = instants(encoder_phase, options.encoder_rate, first, last);
  RecordedTrajectory recorded;
  std::size_t e = 0;
  std::size_t r = 0;
  while (e < exposures.size() || r < readings.size()) {
    const bool exposes =
        r >= readings.size() || (e < exposures.size() && exposures[e] < readings[r]);
    const double now = exposes ? exposures[e++] : readings[r++];
    plant.advanceTo(now);
    if (exposes) {
      recorded.observed.push_back({now, plant.observedPose()});
      recorded.motor_poses.push_back({now, plant.motorPose()});
      recorded.joints.push_back({now, plant.joints()});
    } else {
      recorded.encoders.push_back({now, wholeCounts(physics.nominal, plant.motors())});
    }
  }
  plant.advanceTo(last);
  return recorded;
}

}  // namespace

Recording record(const RobotPhysics& physics, const Motion& motion,
                 const RecorderOptions& options) {
  std::mt19937_64 random(options.seed ^ 0x9e3779b97f4a7c15ULL);
  std::uniform_real_distribution<double> share;
  const double exposure_phase = motion.start() + share(random) / options.frame_rate;
  const double encoder_phase = motion.start() + share(random) / options.encoder_rate;
  RobotPlant plant(physics, motion.approach, motion.start() - kSettleTime - kApproachTime,
                   motion.start());
  approach(motion, plant);
  Recording recording;
  for (const PlannedTrajectory& planned : motion.trajectories)
    recording.trajectories.push_back(
        follow(planned, physics, exposure_phase, encoder_phase, options, plant));
  return recording;
}

JointStream jointCommands(const KinematicChain& robot, const PlannedTrajectory& trajectory) {
  JointStream stream;
  stream.names = robot.jointNames();
  for (std::size_t k = 0; k < trajectory.commands.size(); ++k)
    stream.samples.push_back({trajectory.commands[k].stamp, Eigen::VectorXd(trajectory.joints[k])});
  return stream;
}

}  // namespace raven_correction::plant
