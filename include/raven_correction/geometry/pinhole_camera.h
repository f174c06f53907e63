// SPDX-License-Identifier: BSD-3-Clause
// One camera with lens distortion: from a direction to a pixel of its raw image and back, in the
// terms of sensor_msgs/CameraInfo (K, D, R, P). Two of them that see the same thing are
// stereo_camera.h.
#pragma once

#include <Eigen/Core>

namespace raven_correction {

/// Pixel (0, 0) is the centre of the first pixel; u to the right, v down. A camera frame has x to
/// the right, y down and z along the optical axis. Two frames share the optical centre: `raw`, in
/// which lens and sensor are described, and `rect`, turned so that the rows of a stereo pair are
/// epipolar lines: p_rect = R p_raw.
///
///   n = (x/z, y/z) of p_raw,  r^2 = n.n
///   n_d = n (1 + k1 r^2 + k2 r^4 + k3 r^6) + (2 p1 nx ny + p2 (r^2 + 2 nx^2),
///                                             p1 (r^2 + 2 ny^2) + 2 p2 nx ny)
///   raw pixel = K n_d;  rectified pixel = P p_rect, the lens removed
///
/// Source: Brown 1966; the model `plumb_bob` of sensor_msgs/CameraInfo (k1, k2, p1, p2, k3)
struct PinholeCamera {
  int width = 0;                                            ///< of the raw image [px]
  int height = 0;                                           ///< [px]
  Eigen::Matrix3d K = Eigen::Matrix3d::Identity();          ///< of the raw image [px]
  Eigen::Matrix<double, 5, 1> D = decltype(D)::Zero();      ///< k1, k2, p1, p2, k3 [-]
  Eigen::Matrix3d R = Eigen::Matrix3d::Identity();          ///< R_rect_raw
  Eigen::Matrix<double, 3, 4> P = decltype(P)::Identity();  ///< of the rectified image [px]

  /// n_d of n.
  Eigen::Vector2d distort(const Eigen::Vector2d& n) const noexcept;
  /// n of n_d, by Newton's method from n = n_d. Where a lens folds the image over itself, one of
  /// the solutions or not-a-number.
  Eigen::Vector2d undistort(const Eigen::Vector2d& n_d) const noexcept;
  /// Raw pixel of a point in front of the camera (z > 0 in `raw`).
  Eigen::Vector2d rawPixel(const Eigen::Vector3d& p_rect) const noexcept;
  /// Direction in `rect` that a raw pixel looks along, of length 1.
  Eigen::Vector3d rayOf(const Eigen::Vector2d& raw_pixel) const noexcept;
};

/// @param name  of the camera, for messages
/// @throws InvalidInput  a size or focal length that is not positive, a value that is not finite,
///         R that is no rotation, a lens that folds the image over itself inside its corners
void checkCamera(const PinholeCamera& camera, const char* name);

}  // namespace raven_correction
