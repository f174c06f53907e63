// SPDX-License-Identifier: BSD-3-Clause
#include "raven_correction/simulation/session_statistics.h"

#include <cmath>

#include "raven_correction/dataset/delay.h"
#include "raven_correction/dataset/synchronisation.h"
#include "raven_correction/error.h"
#include "raven_correction/geometry/rigid_fit.h"
#include "raven_correction/geometry/statistics.h"

namespace raven_correction {
namespace {

constexpr double kTrimmed = 0.8;   // share of pairs that the rigid fit looks at
constexpr int kRounds = 10;        // of fitting and trimming
constexpr double kWrong = 1.0472;  // an orientation this far off is wrong, not inexact [rad]
constexpr double kGap = 0.05;      // [s]
constexpr double kJump = 0.005;    // [m]
constexpr double kMaxGap = 0.1;    // of commands bridged for the encoders [s]
constexpr double kDegree = 57.295779513082321;

struct Pairs {
  std::vector<Pose> observations;
  std::vector<PairResidual> residuals;  // position and angle still 0
  FateCounts fates;
};

Pairs makePairs(const Dataset& dataset, double delay) {
  SynchronisationOptions options;
  options.delay = delay;
  Pairs pairs;
  std::size_t number = 0;
  for (const SynchronisedTrajectory& trajectory : synchronise(dataset, options)) {
    pairs.fates += trajectory.fates;
    const StampedPose* before = nullptr;
    for (const CommandPair& pair : trajectory.pairs) {
      const StampedPose& observation = trajectory.observations.samples[pair.sample];
      PairResidual residual;
      residual.trajectory = number;
      residual.command = pair.command;
      if (before != nullptr)
        residual.speed = (pair.command.p - pairs.residuals.back().command.p).norm() /
                         (observation.stamp - before->stamp);
      pairs.observations.push_back(observation.pose);
      pairs.residuals.push_back(residual);
      before = &observation;
    }
    ++number;
  }
  if (pairs.residuals.empty()) throw InvalidInput("no pair of command and observation to look at");
  return pairs;
}

void addRawErrors(const Pairs& pairs, SessionStatistics& statistics) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  std::vector<double> distances;
  std::vector<double> angles;
  for (std::size_t i = 0; i < pairs.residuals.size(); ++i) {
    const Pose& command = pairs.residuals[i].command;
    const Eigen::Vector3d error = pairs.observations[i].p - command.p;
    sum += error.cwiseAbs();
    distances.push_back(error.norm());
    angles.push_back(rotationAngle(command.q, pairs.observations[i].q));
  }
  statistics.raw_position_norm = (sum / static_cast<double>(distances.size())).norm();
  statistics.raw_position_median = median(distances);
  statistics.raw_angle_median = median(angles);
}

/// Rigid fit of the positions to the pairs that it explains best; residuals of all of them.
Pose fitTrimmed(Pairs& pairs) {
  const std::size_t n = pairs.residuals.size();
  std::vector<double> residuals(n, 0.0);
  Pose X;
  double limit = 1.0;
  for (int round = 0; round < kRounds; ++round) {
    RigidFitProblem problem;
    problem.rotation_length = 0.0;
    for (std::size_t i = 0; i < n; ++i) {
      if (round > 0 && residuals[i] > limit) continue;
      problem.from.push_back(pairs.observations[i]);
      problem.to.push_back(pairs.residuals[i].command);
    }
    X = fitRigid(problem).X_b_a;
    for (std::size_t i = 0; i < n; ++i)
      residuals[i] = (X * pairs.observations[i].p - pairs.residuals[i].command.p).norm();
    limit = quantile(residuals, kTrimmed);
  }
  for (std::size_t i = 0; i < n; ++i) pairs.residuals[i].position = residuals[i];
  return X;
}

void fitRigidly(Pairs& pairs) {
  const Pose X = fitTrimmed(pairs);
  // What remains of the orientation is the markers' place on the tool: one rotation for all.
  std::vector<Eigen::Quaterniond> turns;
  for (std::size_t i = 0; i < pairs.residuals.size(); ++i)
    turns.push_back((X.q * pairs.observations[i].q).conjugate() * pairs.residuals[i].command.q);
  Eigen::Quaterniond tool = meanRotation(turns);
  for (int round = 0; round < kRounds; ++round) {
    std::vector<Eigen::Quaterniond> near;
    for (const Eigen::Quaterniond& turn : turns)
      if (rotationAngle(tool, turn) < 0.5) near.push_back(turn);
    if (near.empty()) break;
    tool = meanRotation(near);
  }
  for (std::size_t i = 0; i < turns.size(); ++i)
    pairs.residuals[i].angle = rotationAngle(tool, turns[i]);
}

void addRigidErrors(const Pairs& pairs, SessionStatistics& statistics) {
  std::vector<double> positions;
  std::vector<double> angles;
  std::size_t wrong = 0;
  for (const PairResidual& residual : pairs.residuals) {
    positions.push_back(residual.position);
    angles.push_back(residual.angle);
    if (residual.angle > kWrong) ++wrong;
  }
  statistics.rigid_position_median = median(positions);
  statistics.rigid_position_p95 = quantile(positions, 0.95);
  statistics.angle_median = median(angles);
  statistics.angle_p95 = quantile(angles, 0.95);
  statistics.wrong_share = static_cast<double>(wrong) / static_cast<double>(angles.size());
}

void addTiming(const Dataset& dataset, SessionStatistics& statistics) {
  const std::vector<double> periods = observationIntervals(dataset);
  std::size_t steps = 0;
  std::size_t gaps = 0;
  std::size_t jumps = 0;
  for (const Trajectory& trajectory : dataset.trajectories) {
    const PoseStream& stream = trajectory.observations;
    for (std::size_t k = 1; k < stream.size(); ++k) {
      const double period = stream[k].stamp - stream[k - 1].stamp;
      ++steps;
      if (period > kGap) ++gaps;
      if ((stream[k].pose.p - stream[k - 1].pose.p).norm() > kJump) ++jumps;
    }
  }
  if (periods.empty()) return;
  statistics.period_median = median(periods);
  statistics.period_p95 = quantile(periods, 0.95);
  statistics.gap_share = static_cast<double>(gaps) / static_cast<double>(steps);
  statistics.jump_share = static_cast<double>(jumps) / static_cast<double>(steps);
}

void addEncoders(const Dataset& dataset, SessionStatistics& statistics) {
  std::vector<double> distances;
  for (const Trajectory& trajectory : dataset.trajectories) {
    const PoseStream commands = screenCommands(trajectory.commands).samples;
    for (const StampedPose& sample : trajectory.encoders)
      if (const auto command = poseAt(commands, sample.stamp, kMaxGap))
        distances.push_back((command->p - sample.pose.p).norm());
  }
  if (!distances.empty()) statistics.encoder_median = median(distances);
}

}  // namespace

std::vector<PairResidual> pairResiduals(const Dataset& dataset, double delay) {
  Pairs pairs = makePairs(dataset, delay);
  fitRigidly(pairs);
  return pairs.residuals;
}

std::vector<double> observationIntervals(const Dataset& dataset) {
  std::vector<double> intervals;
  for (const Trajectory& trajectory : dataset.trajectories)
    for (std::size_t k = 1; k < trajectory.observations.size(); ++k) {
      const double interval =
          trajectory.observations[k].stamp - trajectory.observations[k - 1].stamp;
      if (interval > 0.0) intervals.push_back(interval);
    }
  return intervals;
}

SessionStatistics sessionStatistics(const Dataset& dataset) {
  SessionStatistics statistics;
  statistics.delay = estimateDelay(dataset, {}).delay;
  Pairs pairs = makePairs(dataset, statistics.delay);
  fitRigidly(pairs);
  statistics.pairs = pairs.residuals.size();
  statistics.repeated_share =
      static_cast<double>(pairs.fates[Fate::kRepeated]) / static_cast<double>(pairs.fates.total());
  addRawErrors(pairs, statistics);
  addRigidErrors(pairs, statistics);
  addTiming(dataset, statistics);
  addEncoders(dataset, statistics);
  return statistics;
}

std::vector<StatisticsRow> compareStatistics(const SessionStatistics& measured,
                                             const SessionStatistics& simulated) {
  using S = SessionStatistics;
  struct Figure {
    const char* quantity;
    double S::*value;
    double scale;
    const char* unit;
  };
  const Figure figures[] = {
      {"raw position error, norm of mean absolute errors", &S::raw_position_norm, 1e3, "mm"},
      {"raw position error, median", &S::raw_position_median, 1e3, "mm"},
      {"raw orientation error, median", &S::raw_angle_median, kDegree, "deg"},
      {"delay", &S::delay, 1.0, "s"},
      {"position after rigid fit, median", &S::rigid_position_median, 1e3, "mm"},
      {"position after rigid fit, p95", &S::rigid_position_p95, 1e3, "mm"},
      {"orientation after fixed rotations, median", &S::angle_median, kDegree, "deg"},
      {"orientation after fixed rotations, p95", &S::angle_p95, kDegree, "deg"},
      {"orientations more than 60 deg off", &S::wrong_share, 100.0, "%"},
      {"repeated observations", &S::repeated_share, 100.0, "%"},
      {"observation intervals above 50 ms", &S::gap_share, 100.0, "%"},
      {"observation period, median", &S::period_median, 1.0, "s"},
      {"observation period, p95", &S::period_p95, 1.0, "s"},
      {"observation steps above 5 mm", &S::jump_share, 100.0, "%"},
      {"encoders against command, median", &S::encoder_median, 1e3, "mm"}};
  std::vector<StatisticsRow> rows;
  for (const Figure& figure : figures)
    rows.push_back({figure.quantity, figure.scale * (measured.*figure.value),
                    figure.scale * (simulated.*figure.value), figure.unit});
  return rows;
}

}  // namespace raven_correction
