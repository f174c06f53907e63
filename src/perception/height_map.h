// SPDX-License-Identifier: BSD-3-Clause
// How high above the platform the surface of the foam is, pixel by pixel, by matching the texture
// of the two rectified images. The exact position of a fragment comes from outlines
// (fragment_outline.h); this tells what lies on what.
#pragma once

#include <opencv2/core.hpp>

#include "raven_correction/geometry/pose.h"
#include "raven_correction/geometry/stereo_camera.h"

namespace raven_correction {

/// Columns at which a pixel of the left image shows up in the right one if it is at height h:
///
///   u_right = u - cx_left + cx_right + f b n(u, v) / (z_0 - h)
///
/// with z_0 the height of the left camera and n the z component in the field of the pixel's ray of
/// depth 1 (negative: it looks down).
class PlaneSweep {
 public:
  PlaneSweep(const StereoCamera& camera, const Pose& X_field_camera);
  double rightColumn(double u, double v, double height) const noexcept;
  /// d u_right / d height [px/m]
  double columnsPerMetre(double u, double v, double height) const noexcept;

 private:
  Eigen::Vector3d normal_;  // n = normal_ . (u, v, 1)
  double shift_;            // cx_right - cx_left [px]
  double scale_;            // f b [px m]
  double camera_height_;    // z_0 [m]
};

/// For every pixel of the left mask the height in [-1 mm, height_max] whose plane fits best: least
/// sum of absolute differences of brightness, less its local mean, over the foam pixels of a small
/// window, and of what it costs to climb or jump on eight paths over the foam (semi-global
/// matching).
/// Source: Hirschmueller 2008, doi:10.1109/TPAMI.2007.1166
/// @param left, right            8UC3, rectified
/// @param left_mask, right_mask  8UC1
/// @return 32FC1 [m]; NaN outside the mask
cv::Mat heightMap(const cv::Mat& left, const cv::Mat& right, const cv::Mat& left_mask,
                  const cv::Mat& right_mask, const PlaneSweep& sweep, double height_max);

/// The height of a horizontal plane on which a region of the left image fits the right one best:
/// least sum of absolute differences of redness, each limited. A region with its surroundings has
/// an outline, and a flat mark on the platform fits at 0, whatever glints on it.
/// @param left_redness, right_redness  32FC1, redness() of the rectified images
/// @param region                       8UC1, not empty
/// @return in [-2 mm, height_max] [m]
double regionHeight(const cv::Mat& left_redness, const cv::Mat& right_redness,
                    const cv::Mat& region, const PlaneSweep& sweep, double height_max);

}  // namespace raven_correction
