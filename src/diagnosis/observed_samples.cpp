// SPDX-License-Identifier: BSD-3-Clause
#include "observed_samples.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "raven_correction/geometry/statistics.h"

namespace raven_correction {
namespace {

constexpr double kUsual = 0.99;  // share of the samples whose speed is taken for real [-]
constexpr double kBeyond = 1.5;  // times that speed is the limit [-]

/// A single wild speed would rule every regression on speeds and their squares.
void limitSpeeds(std::vector<ObservedSample>& samples) {
  if (samples.empty()) return;
  for (Eigen::Index j = 0; j < samples.front().speed.size(); ++j) {
    std::vector<double> sizes;
    for (const ObservedSample& sample : samples) sizes.push_back(std::abs(sample.speed(j)));
    const double limit = kBeyond * quantile(std::move(sizes), kUsual);
    for (ObservedSample& sample : samples)
      sample.speed(j) = std::clamp(sample.speed(j), -limit, limit);
  }
}

}  // namespace

std::vector<ObservedSample> observedSamples(const Recording& recording,
                                            const ResidualLayout& layout,
                                            const Eigen::MatrixXd& joints) {
  std::vector<ObservedSample> samples;
  std::pair<int, int> last{-1, -1};
  for (std::size_t i = 0; i < layout.blocks.size(); ++i) {
    const ResidualBlock& block = layout.blocks[i];
    if (layout.channels[static_cast<std::size_t>(block.channel)].encoder) continue;
    if (last != std::make_pair(block.motion, block.sample)) {
      last = {block.motion, block.sample};
      const auto& motion = recording.motions[static_cast<std::size_t>(block.motion)];
      samples.push_back({block.motion,
                         motion.observations[static_cast<std::size_t>(block.sample)].stamp,
                         joints.col(static_cast<Eigen::Index>(i)),
                         Eigen::VectorXd::Zero(joints.rows()),
                         {}});
    }
    samples.back().blocks.push_back(i);
  }
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const std::size_t a = i > 0 && samples[i - 1].motion == samples[i].motion ? i - 1 : i;
    const std::size_t b =
        i + 1 < samples.size() && samples[i + 1].motion == samples[i].motion ? i + 1 : i;
    const double step = samples[b].stamp - samples[a].stamp;
    if (step > 0.0) samples[i].speed = (samples[b].joints - samples[a].joints) / step;
  }
  limitSpeeds(samples);
  return samples;
}

Eigen::VectorXd simulatedVelocity(const Recording& recording, const ObservedSample& sample,
                                  const SimulatedSamples& simulated) {
  if (!recording.has_kinematics) return sample.speed;
  Jacobian jacobian;
  recording.robot.forward(JointVector(sample.joints), jacobian);
  Eigen::VectorXd velocity = jacobian * sample.speed;
  velocity.tail<3>() =
      simulated.tool(sample.blocks[0]).conjugate() * Eigen::Vector3d(velocity.tail<3>());
  return velocity;
}

}  // namespace raven_correction
