// SPDX-License-Identifier: BSD-3-Clause
#include "raven_correction/diagnosis/residual_samples.h"

#include <Eigen/Cholesky>
#include <algorithm>

#include "observed_samples.h"
#include "raven_correction/robot/gravity_load.h"

namespace raven_correction {
namespace {

constexpr double kRotationLength = 0.05;  // of an error of the tool [m/rad]
constexpr double kJointLength = 0.1;      // of a revolute joint [m/rad]
constexpr double kDamping = 0.05;         // [-]

bool hasMasses(const KinematicChain& robot) {
  return robot.gravity().norm() > 0.0 &&
         std::any_of(robot.joints().begin(), robot.joints().end(),
                     [](const Joint& joint) { return joint.mass > 0.0; });
}

/// The residual vector of one simulation, sample by sample.
class ResidualWriter {
 public:
  ResidualWriter(const Recording& recording, const ResidualLayout& layout,
                 const SimulatedResidual& of, Eigen::Index count)
      : recording_(recording), layout_(layout), residual_(of.residual), simulated_(of.simulated) {
    if (residual_.size() == 0) return;
    if (recording.has_kinematics) out_.tool.setZero(6, count);
    out_.joints.setZero(recording.robot.size(), count);
  }

  void write(const ObservedSample& sample, Eigen::Index column) {
    if (residual_.size() == 0) return;
    if (!recording_.has_kinematics) {
      for (std::size_t j = 0; j < sample.blocks.size(); ++j)
        out_.joints(static_cast<Eigen::Index>(j), column) =
            residual_(layout_.blocks[sample.blocks[j]].offset);
      return;
    }
    Eigen::Matrix<double, 6, 1> error;
    error << residual_.segment<3>(layout_.blocks[sample.blocks[0]].offset),
        residual_.segment<3>(layout_.blocks[sample.blocks[1]].offset);
    out_.tool.col(column) = error;
    Jacobian jacobian;
    recording_.robot.forward(JointVector(sample.joints), jacobian);
    error.tail<3>() = simulated_.tool(sample.blocks[0]) * Eigen::Vector3d(error.tail<3>());
    out_.joints.col(column) = projectToJoints(recording_.robot, jacobian, error);
  }

  ResidualSamples::Residual take() { return std::move(out_); }

 private:
  const Recording& recording_;
  const ResidualLayout& layout_;
  const Eigen::VectorXd& residual_;
  const SimulatedSamples& simulated_;
  ResidualSamples::Residual out_;
};

}  // namespace

Eigen::VectorXd projectToJoints(const KinematicChain& robot, const Jacobian& jacobian,
                                const Eigen::Matrix<double, 6, 1>& error) {
  Eigen::Matrix<double, 6, 1> weight;
  weight << 1.0, 1.0, 1.0, kRotationLength, kRotationLength, kRotationLength;
  Eigen::VectorXd per_length(robot.size());
  for (int j = 0; j < robot.size(); ++j)
    per_length(j) = robot.joints()[static_cast<std::size_t>(j)].type == JointType::kRevolute
                        ? 1.0 / kJointLength
                        : 1.0;
  const Eigen::MatrixXd A =
      weight.asDiagonal() * Eigen::MatrixXd(jacobian) * per_length.asDiagonal();
  Eigen::MatrixXd H = A.transpose() * A;
  H.diagonal().array() += kDamping * kDamping;
  const Eigen::VectorXd weighted = weight.cwiseProduct(error);
  return per_length.cwiseProduct(Eigen::VectorXd(H.ldlt().solve(A.transpose() * weighted)));
}

ResidualSamples residualSamples(const Recording& recording, const ResidualLayout& layout,
                                const SimulatedResidual& before, const SimulatedResidual& aligned,
                                const SimulatedResidual& after, std::size_t most) {
  const std::vector<ObservedSample> all =
      observedSamples(recording, layout, before.simulated.joints);
  const std::size_t stride = most == 0 ? 1 : (all.size() + most - 1) / most;
  std::vector<const ObservedSample*> chosen;
  for (std::size_t i = 0; i < all.size(); i += std::max<std::size_t>(1, stride))
    chosen.push_back(&all[i]);

  ResidualSamples samples;
  const auto count = static_cast<Eigen::Index>(chosen.size());
  const Eigen::Index rows = recording.robot.size();
  samples.joints.setZero(rows, count);
  samples.speed.setZero(rows, count);
  if (recording.has_kinematics) {
    samples.position.setZero(3, count);
    samples.velocity.setZero(3, count);
    if (hasMasses(recording.robot)) samples.load.setZero(rows, count);
  }
  ResidualWriter writers[] = {{recording, layout, before, count},
                              {recording, layout, aligned, count},
                              {recording, layout, after, count}};
  for (Eigen::Index i = 0; i < count; ++i) {
    const ObservedSample& sample = *chosen[static_cast<std::size_t>(i)];
    samples.stamp.push_back(sample.stamp - all.front().stamp);
    samples.motion.push_back(sample.motion);
    samples.joints.col(i) = sample.joints;
    samples.speed.col(i) = sample.speed;
    if (recording.has_kinematics) {
      const ResidualBlock& block = layout.blocks[sample.blocks[0]];
      samples.position.col(i) = recording.motions[static_cast<std::size_t>(sample.motion)]
                                    .observations[static_cast<std::size_t>(block.sample)]
                                    .pose.p;
      samples.velocity.col(i) = simulatedVelocity(recording, sample, before.simulated).head<3>();
    }
    if (samples.load.rows() > 0)
      samples.load.col(i) = gravityLoad(recording.robot, JointVector(sample.joints), 0.0);
    for (ResidualWriter& writer : writers) writer.write(sample, i);
  }
  samples.before = writers[0].take();
  samples.aligned = writers[1].take();
  samples.after = writers[2].take();
  return samples;
}

}  // namespace raven_correction
