// SPDX-License-Identifier: BSD-3-Clause
#include "linear_residual.h"

#include "parallel.h"

namespace raven_correction {
namespace {

constexpr double kJointStep = 1e-6;  // [rad or m]

}  // namespace

LinearResidual::LinearResidual(const Recording& recording, const ResidualLayout& layout,
                               const SimulationConfig& here, const SimulatedSamples& samples,
                               const Eigen::VectorXd& residual)
    : recording_(recording),
      layout_(layout),
      traced_(layout.timelines->of(recording, here), here),
      slopes_(recording.has_kinematics ? static_cast<std::size_t>(recording.robot.size()) : 0) {
  parallelFor(static_cast<int>(slopes_.size()), [&](int joint) {
    SimulatedSamples moved = samples;
    moved.joints.row(joint).array() += kJointStep;
    slopes_[static_cast<std::size_t>(joint)] =
        (residualsOfJoints(recording, here, moved, residual) - residual) / kJointStep;
  });
}

Eigen::VectorXd LinearResidual::changeTo(const SimulationConfig& there) const {
  const std::shared_ptr<const Timeline> timeline = layout_.timelines->of(recording_, there);
  const JointHistory moved =
      timeline.get() == &traced_.timeline() ? traced_.of(there) : jointHistory(*timeline, there);
  const Eigen::MatrixXd joint = moved.joint - traced_.history().joint;
  Eigen::VectorXd change(layout_.size);
  Eigen::Index at = 0, sample = 0;
  for (const Recording::Motion& motion : recording_.motions)
    for (const Recording::Observation& observation : motion.observations) {
      if (observation.kind == Recording::Observation::Kind::kPose) {
        change.segment<6>(at).setZero();
        for (std::size_t j = 0; j < slopes_.size(); ++j)
          change.segment<6>(at) +=
              joint(static_cast<Eigen::Index>(j), sample) * slopes_[j].segment<6>(at);
        at += 6;
      } else {
        if (observation.kind == Recording::Observation::Kind::kEncoders)
          change.segment(at, joint.rows()) =
              traced_.history().motor.col(sample) - moved.motor.col(sample);
        else
          change.segment(at, joint.rows()) = -joint.col(sample);
        at += joint.rows();
      }
      ++sample;
    }
  return change;
}

}  // namespace raven_correction
