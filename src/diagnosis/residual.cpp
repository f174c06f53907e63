// SPDX-License-Identifier: BSD-3-Clause
#include "raven_correction/diagnosis/residual.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "raven_correction/geometry/rotation.h"
#include "raven_correction/geometry/statistics.h"
#include "raven_correction/simulation/effect_registry.h"
#include "raven_correction/simulation/simulated_arm.h"
#include "timeline.h"

namespace raven_correction {
namespace {

using Kind = Recording::Observation::Kind;

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

Eigen::Matrix<double, 6, 1> poseResidual(const Pose& measured, const Pose& simulated) {
  Eigen::Matrix<double, 6, 1> residual;
  residual << measured.p - simulated.p, logRotation(simulated.q.conjugate() * measured.q);
  return residual;
}

/// What the joints do: all at once where no load depends on them.
JointHistory historyOf(const Recording& recording, const ResidualLayout& layout,
                       const SimulationConfig& simulation) {
  if (needsLoad(simulation)) return steppedJointHistory(recording, simulation);
  return jointHistory(*layout.timelines->of(recording, simulation), simulation);
}

}  // namespace

ResidualLayout residualLayout(const Recording& recording) {
  ResidualLayout layout;
  layout.timelines = std::make_shared<TimelineCache>();
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
                          const SimulationConfig& simulation, SimulatedSamples* simulated,
                          const std::vector<bool>& use) {
  Eigen::VectorXd residual = Eigen::VectorXd::Zero(layout.size);
  if (simulated) {
    const auto count = static_cast<Eigen::Index>(layout.blocks.size());
    simulated->joints.setZero(recording.robot.size(), count);
    simulated->since_start.setZero(count);
    simulated->orientation.setZero(4, count);
  }
  const JointHistory history = historyOf(recording, layout, simulation);
  const SimulatedArm arm(simulation);  // where it has its tool
  Eigen::Index at = 0, block = 0, sample = 0;
  for (std::size_t m = 0; m < recording.motions.size(); ++m) {
    const Recording::Motion& motion = recording.motions[m];
    if (!isUsed(use, static_cast<int>(m))) {
      for (const Recording::Observation& observation : motion.observations) {
        const bool pose = observation.kind == Kind::kPose;
        at += pose ? 6 : recording.robot.size();
        block += pose ? 2 : recording.robot.size();
        ++sample;
      }
      continue;
    }
    for (const Recording::Observation& observation : motion.observations) {
      const double since_start = history.since_start(sample);
      const JointVector joint = history.joint.col(sample);
      const Eigen::Index blocks =
          observation.kind == Kind::kPose ? 2 : static_cast<Eigen::Index>(recording.robot.size());
      if (observation.kind == Kind::kPose) {
        const Pose tool = arm.toolPoseAt(since_start, joint);
        residual.segment<6>(at) = poseResidual(observation.pose, tool);
        if (simulated) simulated->orientation.middleCols(block, blocks).colwise() = tool.q.coeffs();
        at += 6;
      } else {
        const JointVector there =
            observation.kind == Kind::kEncoders ? JointVector(history.motor.col(sample)) : joint;
        residual.segment(at, blocks) = jointDifference(recording.robot, observation.joints, there);
        at += blocks;
      }
      if (simulated) {
        simulated->joints.middleCols(block, blocks).colwise() = Eigen::VectorXd(joint);
        simulated->since_start.segment(block, blocks).setConstant(since_start);
      }
      block += blocks;
      ++sample;
    }
  }
  return residual;
}

bool needsLoad(const SimulationConfig& simulation) {
  return std::any_of(simulation.effects.begin(), simulation.effects.end(),
                     [](const auto& effect) { return effect->needsLoad(); });
}

bool leavesJointsAlone(const SimulationConfig& simulation, const std::string& effect) {
  const EffectStage stage = makeEffect(effect, simulation.robot)->stage();
  // The load of the joints depends on the links.
  return stage == EffectStage::kObservation ||
         (stage == EffectStage::kKinematics && !needsLoad(simulation));
}

Eigen::VectorXd residualsOfJoints(const Recording& recording, const SimulationConfig& simulation,
                                  const SimulatedSamples& simulated,
                                  const Eigen::VectorXd& residual) {
  Eigen::VectorXd result = residual;
  const SimulatedArm arm(simulation);
  Eigen::Index at = 0, block = 0;
  for (const Recording::Motion& motion : recording.motions)
    for (const Recording::Observation& observation : motion.observations) {
      if (observation.kind == Kind::kPose) {
        const Pose tool = arm.toolPoseAt(simulated.since_start(block), simulated.joints.col(block));
        result.segment<6>(at) = poseResidual(observation.pose, tool);
        at += 6;
        block += 2;
      } else {
        at += recording.robot.size();
        block += recording.robot.size();
      }
    }
  return result;
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
