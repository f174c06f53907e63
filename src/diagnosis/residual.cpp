// SPDX-License-Identifier: BSD-3-Clause
#include "raven_correction/diagnosis/residual.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "raven_correction/geometry/rotation.h"
#include "raven_correction/geometry/statistics.h"
#include "raven_correction/simulation/simulated_arm.h"

namespace raven_correction {
namespace {

using Kind = Recording::Observation::Kind;

constexpr double kLongestStep = 0.1;  // every operator is exact for held set-points [s]
constexpr double kPause = 0.2;  // between motions; shorter: one goes on where the other ends [s]
// A command of the very stamp of an observation has been carried out: recordings that go from stop
// to stop have one stamp for both [s].
constexpr double kAfter = 1e-6;
constexpr double kSmallestLength = 1e-6;  // below it nothing is measured [m]
constexpr double kSmallestAngle = 1e-5;   // [rad]
constexpr double kHuberThreshold = 3.0;   // in standard deviations of the components [-]
constexpr double kPi = 3.14159265358979323846;

bool isRevolute(const KinematicChain& robot, int joint) {
  return robot.joints()[static_cast<std::size_t>(joint)].type == JointType::kRevolute;
}

/// Difference of two joint vectors, revolute joints modulo a turn.
JointVector jointDifference(const KinematicChain& robot, const JointVector& a,
                            const JointVector& b) {
  JointVector difference = a - b;
  for (int j = 0; j < robot.size(); ++j)
    if (isRevolute(robot, j)) difference(j) = std::remainder(difference(j), 2.0 * kPi);
  return difference;
}

/// Feeds the arm the set-points of one motion after the other.
class Replay {
 public:
  explicit Replay(const SimulationConfig& simulation) : arm_(simulation) {}

  void begin(const Recording::Motion& motion) {
    motion_ = &motion;
    next_ = 0;
    const Recording::Setpoint& first = motion.setpoints.front();
    const double start = std::min(first.stamp, motion.observations.front().stamp);
    if (fresh_ || start < arm_.time()) {
      arm_.reset(start, first.joints);
      fresh_ = false;
    } else if (first.stamp - arm_.state().last_stamp > kPause) {
      arm_.command(std::max(arm_.time(), arm_.state().last_stamp), first.joints);
    }
  }
  /// The arm at this instant of the motion.
  const SimulatedArm& at(double stamp) {
    // One set-point beyond the instant, because linear set-points look ahead.
    while (next_ < motion_->setpoints.size() &&
           (next_ == 0 || motion_->setpoints[next_ - 1].stamp <= stamp))
      take();
    arm_.advanceTo(stamp + kAfter);
    return arm_;
  }
  void end() {
    while (next_ < motion_->setpoints.size()) take();
  }

 private:
  void take() {
    const Recording::Setpoint& setpoint = motion_->setpoints[next_++];
    arm_.command(setpoint.stamp, setpoint.joints);
  }
  SimulatedArm arm_;
  const Recording::Motion* motion_ = nullptr;
  std::size_t next_ = 0;
  bool fresh_ = true;
};

}  // namespace

ResidualLayout residualLayout(const Recording& recording) {
  ResidualLayout layout;
  layout.motions = static_cast<int>(recording.motions.size());
  const auto addJointChannels = [&](const std::string& prefix, bool encoder) {
    for (int j = 0; j < recording.robot.size(); ++j)
      layout.channels.push_back({prefix + recording.robot.jointNames()[static_cast<std::size_t>(j)],
                                 isRevolute(recording.robot, j) ? "rad" : "m", 1, encoder});
  };
  if (recording.has_kinematics)
    layout.channels = {{"position", "m", 3, false}, {"orientation", "rad", 3, false}};
  else
    addJointChannels("", false);
  const int first_encoder = static_cast<int>(layout.channels.size());
  if (recording.has_encoders) addJointChannels("encoder ", true);

  for (int m = 0; m < layout.motions; ++m) {
    const auto& observations = recording.motions[static_cast<std::size_t>(m)].observations;
    for (std::size_t s = 0; s < observations.size(); ++s) {
      const Kind kind = observations[s].kind;
      const int first = kind == Kind::kEncoders ? first_encoder : 0;
      const int count = kind == Kind::kPose ? 2 : recording.robot.size();
      for (int c = first; c < first + count; ++c) {
        layout.blocks.push_back({c, m, static_cast<int>(s), layout.size});
        layout.size += layout.channels[static_cast<std::size_t>(c)].size;
      }
    }
  }
  return layout;
}

Eigen::Quaterniond SimulatedSamples::tool(std::size_t block) const {
  const Eigen::Vector4d coefficients = orientation.col(static_cast<Eigen::Index>(block));
  if (coefficients.isZero(0.0)) return Eigen::Quaterniond::Identity();
  return Eigen::Quaterniond(coefficients);
}

Eigen::VectorXd residuals(const Recording& recording, const ResidualLayout& layout,
                          const SimulationConfig& simulation, SimulatedSamples* simulated) {
  SimulationConfig config = simulation;
  config.step = kLongestStep;
  Eigen::VectorXd residual(layout.size);
  if (simulated) {
    const auto count = static_cast<Eigen::Index>(layout.blocks.size());
    simulated->joints.resize(recording.robot.size(), count);
    simulated->orientation.setZero(4, count);
  }
  Replay replay(config);
  Eigen::Index at = 0, block = 0;
  for (const Recording::Motion& motion : recording.motions) {
    replay.begin(motion);
    for (const Recording::Observation& observation : motion.observations) {
      const SimulatedArm& arm = replay.at(observation.stamp);
      const Eigen::Index blocks =
          observation.kind == Kind::kPose ? 2 : static_cast<Eigen::Index>(recording.robot.size());
      if (observation.kind == Kind::kPose) {
        const Pose tool = arm.toolPose();
        residual.segment<3>(at) = observation.pose.p - tool.p;
        residual.segment<3>(at + 3) = logRotation(tool.q.conjugate() * observation.pose.q);
        if (simulated) simulated->orientation.middleCols(block, blocks).colwise() = tool.q.coeffs();
        at += 6;
      } else {
        const JointVector& there =
            observation.kind == Kind::kEncoders ? arm.motorJoints() : arm.joints();
        residual.segment(at, blocks) = jointDifference(recording.robot, observation.joints, there);
        at += blocks;
      }
      if (simulated)
        simulated->joints.middleCols(block, blocks).colwise() = Eigen::VectorXd(arm.joints());
      block += blocks;
    }
    replay.end();
  }
  return residual;
}

Eigen::VectorXd channelScales(const ResidualLayout& layout, const Eigen::VectorXd& residual,
                              const std::vector<bool>& use) {
  std::vector<std::vector<double>> values(layout.channels.size());
  for (const ResidualBlock& block : layout.blocks) {
    if (!isUsed(use, block.motion)) continue;
    const auto c = static_cast<std::size_t>(block.channel);
    for (int i = 0; i < layout.channels[c].size; ++i)
      values[c].push_back(std::abs(residual(block.offset + i)));
  }
  Eigen::VectorXd scales(static_cast<Eigen::Index>(values.size()));
  for (std::size_t c = 0; c < values.size(); ++c) {
    const double least = layout.channels[c].unit == "m" ? kSmallestLength : kSmallestAngle;
    const double middle = values[c].empty() ? 0.0 : median(std::move(values[c]));
    scales(static_cast<Eigen::Index>(c)) = std::max(least, 1.4826 * middle);
  }
  return scales;
}

double blockThreshold(int size) noexcept {
  return kHuberThreshold * std::sqrt(static_cast<double>(size));
}

double huber(double s, double threshold) noexcept {
  return s <= threshold ? 0.5 * s * s : threshold * (s - 0.5 * threshold);
}

Eigen::VectorXd motionLosses(const ResidualLayout& layout, const Eigen::VectorXd& residual,
                             const Eigen::VectorXd& scales) {
  const auto channels = static_cast<Eigen::Index>(layout.channels.size());
  Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(channels, layout.motions);
  Eigen::MatrixXd count = Eigen::MatrixXd::Zero(channels, layout.motions);
  for (const ResidualBlock& block : layout.blocks) {
    const int size = layout.sizeOf(block);
    const double s = residual.segment(block.offset, size).norm() / scales(block.channel);
    sum(block.channel, block.motion) += huber(s, blockThreshold(size)) / size;
    count(block.channel, block.motion) += 1.0;
  }
  Eigen::VectorXd losses(layout.motions);
  for (int m = 0; m < layout.motions; ++m) {
    double total = 0.0;
    int present = 0;
    for (Eigen::Index c = 0; c < channels; ++c) {
      if (count(c, m) == 0.0) continue;
      total += sum(c, m) / count(c, m);
      ++present;
    }
    losses(m) = present ? total / present : std::numeric_limits<double>::quiet_NaN();
  }
  return losses;
}

Eigen::VectorXd channelWeights(const ResidualLayout& layout) {
  Eigen::VectorXd count = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(layout.channels.size()));
  for (const ResidualBlock& block : layout.blocks) count(block.channel) += layout.sizeOf(block);
  const double mean = count.mean();
  return count.unaryExpr([&](double n) { return n > 0.0 ? mean / n : 0.0; });
}

Eigen::VectorXd rowWeights(const ResidualLayout& layout, const Eigen::VectorXd& residual,
                           const Eigen::VectorXd& scales) {
  const Eigen::VectorXd channel = channelWeights(layout);
  Eigen::VectorXd weights(layout.size);
  for (const ResidualBlock& block : layout.blocks) {
    const int size = layout.sizeOf(block);
    const double scale = scales(block.channel);
    const double s = residual.segment(block.offset, size).norm() / scale;
    const double threshold = blockThreshold(size);
    const double robust = s <= threshold ? 1.0 : threshold / s;
    weights.segment(block.offset, size)
        .setConstant(robust * channel(block.channel) / (scale * scale));
  }
  return weights;
}

ErrorSizes errorSizes(const ResidualLayout& layout, const Eigen::VectorXd& residual,
                      const std::vector<bool>& use) {
  std::vector<std::vector<double>> lengths(layout.channels.size());
  for (const ResidualBlock& block : layout.blocks) {
    const auto c = static_cast<std::size_t>(block.channel);
    if (isUsed(use, block.motion) && !layout.channels[c].encoder)
      lengths[c].push_back(residual.segment(block.offset, layout.channels[c].size).norm());
  }
  ErrorSizes sizes;
  const auto rms = [](const std::vector<double>& values) {
    double sum = 0.0;
    for (const double v : values) sum += v * v;
    return values.empty() ? 0.0 : std::sqrt(sum / static_cast<double>(values.size()));
  };
  const auto middle = [](const std::vector<double>& values, double q) {
    return values.empty() ? 0.0 : quantile(values, q);
  };
  for (std::size_t c = 0; c < lengths.size(); ++c) {
    const Channel& channel = layout.channels[c];
    if (channel.encoder) continue;
    sizes.samples = std::max(sizes.samples, lengths[c].size());
    if (channel.name == "position" && channel.size == 3) {
      sizes.position_rms = rms(lengths[c]);
      sizes.position_median = middle(lengths[c], 0.5);
      sizes.position_p95 = middle(lengths[c], 0.95);
    } else if (channel.size == 3) {
      sizes.orientation_median = middle(lengths[c], 0.5);
      sizes.orientation_rms = rms(lengths[c]);
    } else {
      sizes.joint_rms.push_back(rms(lengths[c]));
      sizes.joint_median.push_back(middle(lengths[c], 0.5));
      sizes.joint_p95.push_back(middle(lengths[c], 0.95));
    }
  }
  return sizes;
}

}  // namespace raven_correction
