// SPDX-License-Identifier: BSD-3-Clause
// Two cameras side by side: where a point is that both see. One camera and its lens are
// pinhole_camera.h. The points are in the `rect` frame of the left camera, here called `camera`.
#pragma once

#include "raven_correction/geometry/pinhole_camera.h"

namespace raven_correction {

/// A point as both rectified images show it: one row, two columns.
struct StereoPixel {
  double u_left = 0.0;   ///< [px]
  double u_right = 0.0;  ///< [px]
  double v = 0.0;        ///< [px]
};

/// Both `rect` frames have the same axes; the right one stands at (baseline, 0, 0) in the left one.
///
///   baseline = -P_right(0, 3) / P_right(0, 0)
///   d = (u_left - cx_left) - (u_right - cx_right) = f baseline / z
struct StereoCamera {
  PinholeCamera left;
  PinholeCamera right;

  double baseline() const noexcept { return -right.P(0, 3) / right.P(0, 0); }  ///< [m]
  /// Rectified pixels of a point; z must be > 0.
  StereoPixel project(const Eigen::Vector3d& p_camera) const noexcept;
  /// The point of a pair of pixels; z is negative or infinite where the columns are in the wrong
  /// order.
  Eigen::Vector3d triangulate(const StereoPixel& pixel) const noexcept;
  /// d triangulate / d (u_left, u_right, v): 3x3 [m/px]. A covariance of pixels S becomes one of
  /// the point by J S J^T.
  Eigen::Matrix3d triangulationJacobian(const StereoPixel& pixel) const noexcept;
  /// Raw pixels in one image of a point, e.g. to draw it.
  Eigen::Vector2d leftRawPixel(const Eigen::Vector3d& p_camera) const noexcept;
  Eigen::Vector2d rightRawPixel(const Eigen::Vector3d& p_camera) const noexcept;
};

/// @throws InvalidInput  see checkCamera(); projection matrices that do not belong together
///         (another focal length or row), or a right camera that does not stand to the right
void checkStereoCamera(const StereoCamera& camera);

}  // namespace raven_correction
