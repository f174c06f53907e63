// SPDX-License-Identifier: BSD-3-Clause
#include "raven_correction/geometry/stereo_camera.h"

#include <cmath>

#include "raven_correction/error.h"

namespace raven_correction {

StereoPixel StereoCamera::project(const Eigen::Vector3d& p_camera) const noexcept {
  const auto& P = left.P;
  const double x = P(0, 0) * p_camera.x() / p_camera.z();
  return {x + P(0, 2), x + (right.P(0, 3) / p_camera.z()) + right.P(0, 2),
          P(1, 1) * p_camera.y() / p_camera.z() + P(1, 2)};
}

Eigen::Vector3d StereoCamera::triangulate(const StereoPixel& pixel) const noexcept {
  const auto& P = left.P;
  const double d = (pixel.u_left - P(0, 2)) - (pixel.u_right - right.P(0, 2));
  const double z = P(0, 0) * baseline() / d;
  return {(pixel.u_left - P(0, 2)) / P(0, 0) * z, (pixel.v - P(1, 2)) / P(1, 1) * z, z};
}

Eigen::Matrix3d StereoCamera::triangulationJacobian(const StereoPixel& pixel) const noexcept {
  const auto& P = left.P;
  const Eigen::Vector3d p = triangulate(pixel);
  const double d = P(0, 0) * baseline() / p.z();
  Eigen::Matrix3d J;
  J.col(0) = -p / d + Eigen::Vector3d(p.z() / P(0, 0), 0.0, 0.0);
  J.col(1) = p / d;
  J.col(2) = Eigen::Vector3d(0.0, p.z() / P(1, 1), 0.0);
  return J;
}

Eigen::Vector2d StereoCamera::leftRawPixel(const Eigen::Vector3d& p_camera) const noexcept {
  return left.rawPixel(p_camera);
}

Eigen::Vector2d StereoCamera::rightRawPixel(const Eigen::Vector3d& p_camera) const noexcept {
  return right.rawPixel(p_camera - Eigen::Vector3d(baseline(), 0.0, 0.0));
}

void checkStereoCamera(const StereoCamera& camera) {
  checkCamera(camera.left, "left");
  checkCamera(camera.right, "right");
  const auto& L = camera.left.P;
  const auto& R = camera.right.P;
  const double tolerance = 1e-6 * L(0, 0);
  if (std::abs(L(0, 0) - R(0, 0)) > tolerance || std::abs(L(1, 1) - R(1, 1)) > tolerance ||
      std::abs(L(1, 2) - R(1, 2)) > 1e-3)
    throw InvalidInput(
        format("stereo camera: P of left and right do not belong together: focal lengths %g, %g "
               "and %g, %g px, rows of the centre %g and %g; calibrate both as one pair",
               L(0, 0), L(1, 1), R(0, 0), R(1, 1), L(1, 2), R(1, 2)));
  if (L(0, 3) != 0.0)
    throw InvalidInput(
        format("stereo camera: P of left has %g px m in its last column, must be 0; are left and "
               "right swapped?",
               L(0, 3)));
  if (!(camera.baseline() > 0.0))
    throw InvalidInput(
        format("stereo camera: baseline %g m, must be > 0: P of right needs -focal length x "
               "baseline in its last column; are left and right swapped, or calibrated one by one?",
               camera.baseline()));
}

}  // namespace raven_correction
