// SPDX-License-Identifier: BSD-3-Clause
#include "raven_correction/correction/model.h"

namespace raven_correction {

double distanceFromWorkspace(const Eigen::Vector3d& p, const TrustRegion& trust) noexcept {
  return (p - p.cwiseMax(trust.workspace_min).cwiseMin(trust.workspace_max)).norm();
}

std::size_t featureCount(const MotionOptions& options) noexcept {
  return 6 * (1 + twistCount(options) + (hasPlay(options) ? 1 : 0));
}

void computeFeatures(const Motion& motion, const Pose& rigid,
                     const Eigen::Quaterniond& mean_orientation, const MotionOptions& options,
                     double* features) noexcept {
  const std::size_t twists = twistCount(options);
  Eigen::Map<Eigen::Matrix<double, 6, Eigen::Dynamic, Eigen::ColMajor, 6, kMaxFeatures / 6>> x(
      features, 6, static_cast<Eigen::Index>(featureCount(options) / 6));
  const Pose after = rigid * motion.pose;
  x.col(0) << after.p, logRotation(mean_orientation.conjugate() * after.q);
  for (std::size_t k = 0; k < twists; ++k)
    x.col(static_cast<Eigen::Index>(1 + k)) << rigid.q * motion.twists[k].v,
        rigid.q * motion.twists[k].w;
  if (hasJointPlay(options))
    x.col(static_cast<Eigen::Index>(1 + twists)) = motion.joint_play;
  else if (hasPlay(options))
    x.col(static_cast<Eigen::Index>(1 + twists)) << rigid.q * motion.play.p,
        rigid.q * motion.play.r;
}

Eigen::Matrix<double, 6, 1> correctionBetween(const Pose& after_rigid,
                                              const Pose& command) noexcept {
  Eigen::Matrix<double, 6, 1> y;
  y << command.p - after_rigid.p, logRotation(after_rigid.q.conjugate() * command.q);
  return y;
}

Pose applyCorrection(const Pose& after_rigid, const Eigen::Matrix<double, 6, 1>& y) noexcept {
  return {after_rigid.p + y.head<3>(), (after_rigid.q * expRotation(y.tail<3>())).normalized()};
}

}  // namespace raven_correction
