// SPDX-License-Identifier: BSD-3-Clause
#include "raven_correction/geometry/pinhole_camera.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <cmath>

#include "raven_correction/error.h"

namespace raven_correction {
namespace {

constexpr int kNewtonSteps = 12;
constexpr double kFoldTolerance = 1e-6;  // of a direction after the lens and back [-]

/// d n_d / d n
Eigen::Matrix2d distortionJacobian(const Eigen::Matrix<double, 5, 1>& D, const Eigen::Vector2d& n) {
  const double x = n.x();
  const double y = n.y();
  const double r2 = n.squaredNorm();
  const double radial = 1.0 + r2 * (D(0) + r2 * (D(1) + r2 * D(4)));
  const double slope = 2.0 * (D(0) + r2 * (2.0 * D(1) + 3.0 * r2 * D(4)));  // d radial = slope n.dn
  Eigen::Matrix2d J;
  J << radial + slope * x * x + 2.0 * D(2) * y + 6.0 * D(3) * x,
      slope * x * y + 2.0 * D(2) * x + 2.0 * D(3) * y,
      slope * x * y + 2.0 * D(2) * x + 2.0 * D(3) * y,
      radial + slope * y * y + 6.0 * D(2) * y + 2.0 * D(3) * x;
  return J;
}

}  // namespace

Eigen::Vector2d PinholeCamera::distort(const Eigen::Vector2d& n) const noexcept {
  const double r2 = n.squaredNorm();
  const double radial = 1.0 + r2 * (D(0) + r2 * (D(1) + r2 * D(4)));
  const double xy = n.x() * n.y();
  return radial * n + Eigen::Vector2d(2.0 * D(2) * xy + D(3) * (r2 + 2.0 * n.x() * n.x()),
                                      D(2) * (r2 + 2.0 * n.y() * n.y()) + 2.0 * D(3) * xy);
}

Eigen::Vector2d PinholeCamera::undistort(const Eigen::Vector2d& n_d) const noexcept {
  Eigen::Vector2d n = n_d;
  for (int step = 0; step < kNewtonSteps; ++step) {
    const Eigen::Vector2d change = distortionJacobian(D, n).inverse() * (n_d - distort(n));
    n += change;
    if (change.squaredNorm() < 1e-28) break;
  }
  return n;
}

Eigen::Vector2d PinholeCamera::rawPixel(const Eigen::Vector3d& p_rect) const noexcept {
  const Eigen::Vector3d p_raw = R.transpose() * p_rect;
  return (K * distort(p_raw.hnormalized()).homogeneous()).hnormalized();
}

Eigen::Vector3d PinholeCamera::rayOf(const Eigen::Vector2d& raw_pixel) const noexcept {
  const double ny = (raw_pixel.y() - K(1, 2)) / K(1, 1);
  const double nx = (raw_pixel.x() - K(0, 2) - K(0, 1) * ny) / K(0, 0);
  return (R * undistort({nx, ny}).homogeneous()).normalized();
}

void checkCamera(const PinholeCamera& camera, const char* name) {
  if (camera.width <= 0 || camera.height <= 0)
    throw InvalidInput(format("%s camera: image size %d x %d, must be > 0; is it calibrated?", name,
                              camera.width, camera.height));
  if (!camera.K.allFinite() || !camera.D.allFinite() || !camera.R.allFinite() ||
      !camera.P.allFinite())
    throw InvalidInput(format("%s camera: K, D, R or P has a value that is not finite", name));
  if (!(camera.K(0, 0) > 0.0 && camera.K(1, 1) > 0.0 && camera.P(0, 0) > 0.0 &&
        camera.P(1, 1) > 0.0))
    throw InvalidInput(
        format("%s camera: focal lengths K %g, %g and P %g, %g px must be > 0; zeros mean that "
               "the camera is not calibrated",
               name, camera.K(0, 0), camera.K(1, 1), camera.P(0, 0), camera.P(1, 1)));
  const double turn_error = (camera.R * camera.R.transpose() - Eigen::Matrix3d::Identity()).norm();
  if (!(turn_error < 1e-4 && camera.R.determinant() > 0.0))
    throw InvalidInput(format("%s camera: R is no rotation (|R R^T - I| = %g)", name, turn_error));
  for (const double u : {0.0, camera.width - 1.0})
    for (const double v : {0.0, camera.height - 1.0}) {
      const double ny = (v - camera.K(1, 2)) / camera.K(1, 1);
      const Eigen::Vector2d n_d((u - camera.K(0, 2) - camera.K(0, 1) * ny) / camera.K(0, 0), ny);
      const Eigen::Vector2d n = camera.undistort(n_d);
      if (!((camera.distort(n) - n_d).norm() < kFoldTolerance &&
            distortionJacobian(camera.D, n).determinant() > 0.0))
        throw InvalidInput(
            format("%s camera: the distortion (%g, %g, %g, %g, %g) cannot be undone at pixel "
                   "(%g, %g); calibrate again with points near the corners",
                   name, camera.D(0), camera.D(1), camera.D(2), camera.D(3), camera.D(4), u, v));
    }
}

}  // namespace raven_correction
