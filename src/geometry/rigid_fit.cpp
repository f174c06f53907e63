// SPDX-License-Identifier: BSD-3-Clause
#include "raven_correction/geometry/rigid_fit.h"

#include <Eigen/SVD>
#include <cmath>

#include "raven_correction/error.h"

namespace raven_correction {

RigidFitResult fitRigid(const RigidFitProblem& problem) {
  const std::size_t n = problem.from.size();
  if (n != problem.to.size())
    throw InvalidInput(format("rigid fit: %zu poses to map onto %zu; the lists must be pairs", n,
                              problem.to.size()));
  if (n == 0) throw InvalidInput("rigid fit: no pose to fit; at least one pair is needed");
  if (!(problem.rotation_length >= 0.0) || !std::isfinite(problem.rotation_length))
    throw InvalidInput(format("rigid fit: rotation_length = %g m, must be >= 0 and finite",
                              problem.rotation_length));
  Eigen::Vector3d mean_from = Eigen::Vector3d::Zero(), mean_to = Eigen::Vector3d::Zero();
  for (std::size_t i = 0; i < n; ++i) {
    if (!isFinite(problem.from[i]) || !isFinite(problem.to[i]))
      throw InvalidInput(format("rigid fit: pair %zu of %zu is not finite; remove it first", i, n));
    mean_from += problem.from[i].p;
    mean_to += problem.to[i].p;
  }
  mean_from /= static_cast<double>(n);
  mean_to /= static_cast<double>(n);

  const double weight = problem.rotation_length * problem.rotation_length;
  Eigen::Matrix3d H = Eigen::Matrix3d::Zero();
  for (std::size_t i = 0; i < n; ++i) {
    H += (problem.to[i].p - mean_to) * (problem.from[i].p - mean_from).transpose();
    if (weight > 0.0)
      H += weight * (problem.to[i].q * problem.from[i].q.conjugate()).toRotationMatrix();
  }

  RigidFitResult result;
  // R maximises trace(R^T H), which is what the nearest rotation to H does.
  result.X_b_a.q = Eigen::Quaterniond(nearestRotation(H)).normalized();
  result.X_b_a.p = mean_to - result.X_b_a.q * mean_from;
  const Eigen::Vector3d singular = H.jacobiSvd().singularValues();
  result.status = singular(1) > 1e-12 * singular(0) ? RigidFitResult::Status::kOk
                                                    : RigidFitResult::Status::kDegenerate;
  double position = 0.0, angle = 0.0;
  for (std::size_t i = 0; i < n; ++i) {
    const Pose mapped = result.X_b_a * problem.from[i];
    position += (problem.to[i].p - mapped.p).squaredNorm();
    const double turn = rotationAngle(problem.to[i].q, mapped.q);
    angle += turn * turn;
  }
  result.rms_position = std::sqrt(position / static_cast<double>(n));
  result.rms_angle = std::sqrt(angle / static_cast<double>(n));
  return result;
}

}  // namespace raven_correction
