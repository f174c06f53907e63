// SPDX-License-Identifier: BSD-3-Clause
#include "raven_correction/simulation/excitation_motion.h"

#include <algorithm>
#include <cmath>

#include "raven_correction/error.h"
#include "raven_correction/simulation/minimum_jerk.h"

namespace raven_correction {
namespace {

constexpr double kLimitMargin = 0.02;  // share of a joint's range that strokes keep from its limits
constexpr double kApproachTime = 1.5;  // of an approach to a new posture [s]
constexpr double kBetween = 0.3;       // between two trajectories [s]

void check(const ExcitationConfig& config) {
  if (!(config.amplitude > 0.0 && config.amplitude <= 0.4))
    throw InvalidInput(format("excitation: amplitude = %g of a joint's range, must be in (0, 0.4]",
                              config.amplitude));
  if (!(config.pause >= 0.0 && config.pause <= 10.0))
    throw InvalidInput(format("excitation: pause = %g s is outside [0, 10]", config.pause));
  for (const double time : config.stroke_times)
    if (!(time > 0.0 && time <= 60.0))
      throw InvalidInput(format("excitation: a stroke of %g s is outside (0, 60]", time));
}

/// Writes a joint motion, stroke by stroke, as tool poses.
class Writer {
 public:
  Writer(const KinematicChain& robot, double rate, double start)
      : robot_(robot), period_(1.0 / rate), start_(start), time_(start) {}

  void begin(const JointVector& q) { q_ = q; }
  void stroke(const JointVector& to, double duration, double pause, PoseStream& commands) {
    const double begin = time_;
    const JointVector from = q_;
    while (time_ < begin + duration + pause) {
      const double s = minimumJerk((time_ - begin) / duration);
      q_ = from + s * (to - from);
      commands.push_back({time_, robot_.forward(q_)});
      next();
    }
    q_ = to;
  }
  void wait(double duration) {
    const double until = time_ + duration;
    while (time_ < until) next();
  }

 private:
  void next() { time_ = start_ + ++ticks_ * period_; }

  const KinematicChain& robot_;
  double period_;
  double start_;
  double time_;
  int ticks_ = 0;
  JointVector q_;
};

}  // namespace

std::vector<ExcitationTrajectory> excitationMotions(const ExcitationConfig& config,
                                                    const DebridementConfig& field,
                                                    const KinematicChain& robot, double start,
                                                    std::uint64_t seed) {
  check(config);
  DebridementMotion postures(field, robot, seed);
  const InverseKinematics ik(robot);
  Writer writer(robot, field.rate, start);
  writer.begin(ik.solve(postures.rest(), robot.home()).joints);
  std::vector<ExcitationTrajectory> trajectories;
  for (const double stroke_time : config.stroke_times) {
    for (int j = 0; j < robot.size(); ++j) {
      const JointVector base = ik.solve(postures.randomTarget(), robot.home()).joints;
      ExcitationTrajectory approach;
      approach.label = "approach";
      writer.stroke(base, kApproachTime, config.pause, approach.commands);
      writer.wait(kBetween);
      trajectories.push_back(std::move(approach));

      const double range = robot.upper()(j) - robot.lower()(j);
      const double room = std::min(robot.upper()(j) - base(j), base(j) - robot.lower()(j));
      const double amplitude =
          std::max(0.0, std::min(config.amplitude * range, room - kLimitMargin * range));
      const JointVector up = base + amplitude * JointVector::Unit(robot.size(), j);
      const JointVector down = base - amplitude * JointVector::Unit(robot.size(), j);
      ExcitationTrajectory strokes;
      strokes.label =
          robot.joints()[static_cast<std::size_t>(j)].name + format("_%.1fs", stroke_time);
      writer.stroke(up, stroke_time, config.pause, strokes.commands);
      writer.stroke(down, 2.0 * stroke_time, config.pause, strokes.commands);
      writer.stroke(up, 2.0 * stroke_time, config.pause, strokes.commands);
      writer.stroke(base, stroke_time, config.pause, strokes.commands);
      writer.wait(kBetween);
      trajectories.push_back(std::move(strokes));
    }
  }
  return trajectories;
}

}  // namespace raven_correction
