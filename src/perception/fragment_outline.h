// SPDX-License-Identifier: BSD-3-Clause
// From the pixels of a piece to the middle of the fragment it belongs to: its outline where it is
// its own, and a fitted one where something lies on the fragment. Works in pixels of rectified
// images.
#pragma once

#include <Eigen/Core>
#include <opencv2/core.hpp>
#include <vector>

namespace raven_correction {

/// A piece in one image.
struct Outline {
  std::vector<cv::Point> contour;    ///< of the largest connected part
  std::vector<Eigen::Vector2d> own;  ///< its points where the fragment itself ends [px]
  double hidden_share = 0.0;         ///< of the contour that is the edge of what lies on it
  double touching_share = 0.0;       ///< of the contour that lies against another piece
  double area = 0.0;                 ///< [px^2]
  Eigen::Vector2d centre{0.0, 0.0};  ///< of the area [px]
  Eigen::Vector2d variance{0.0,
                           0.0};  ///< of the centre along u and v, by noise of the contour [px^2]
};

/// @param hides  by number of a piece: whether it lies on this one; element 0 is not used
/// @param noise  of a point of the contour, one standard deviation [px]
/// @return an empty contour where the piece has no pixel
Outline traceOutline(const cv::Mat& labels, int piece, const std::vector<bool>& hides,
                     double noise);

/// The middle of a fragment in both images: u_left, u_right, v, and their covariance.
struct OutlineCentre {
  Eigen::Vector3d pixel = Eigen::Vector3d::Zero();       ///< [px]
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();  ///< [px^2]
  double half_length = 0.0;                              ///< of the fitted outline [px]
  double half_width = 0.0;                               ///< [px]
  double angle = 0.0;                                    ///< of its long axis from u to v [rad]
  bool converged = true;
};

/// The means of what both outlines say.
OutlineCentre meanCentre(const Outline& left, const Outline& right);

/// One superellipse |x/a|^3 + |y/b|^3 = 1 at (u_left, v) and (u_right, v) through the own points of
/// both outlines: least squares of their distances, over the deviation of a real outline from it,
/// with a prior on both half axes (what is typical for this field). Levenberg-Marquardt.
/// @param typical    mean half axis [px]
/// @param deviation  of a half axis from it, one standard deviation [px]
/// @param roughness  of an outline about the superellipse, one standard deviation [px]
OutlineCentre fitCentre(const Outline& left, const Outline& right, double typical, double deviation,
                        double roughness);

}  // namespace raven_correction
