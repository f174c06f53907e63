// SPDX-License-Identifier: BSD-3-Clause
// The surface of one piece of foam as a plane of heights over the left image, robust against the
// outliers of height_map.h.
#pragma once

#include <Eigen/Core>
#include <opencv2/core.hpp>
#include <vector>

namespace raven_correction {

/// h = c . (u - u_0, v - v_0, 1) [m]
struct PieceSurface {
  cv::Point origin;                      ///< (u_0, v_0)
  Eigen::Vector3d c{0.0, 0.0, 0.0};      ///< [m/px, m/px, m]
  double at(double u, double v) const {  ///< [m]
    return c.dot(Eigen::Vector3d(u - origin.x, v - origin.y, 1.0));
  }
};

/// Least squares through the heights of some pixels, what is more than 1 mm off left out.
/// @param height  32FC1 [m]
PieceSurface fitSurface(const std::vector<cv::Point>& pixels, const cv::Mat& height);

/// Median; the order of the values changes. NaN if there is none.
double medianOf(std::vector<float>& values);

/// Median over the pixels of each piece; element 0 is not used. NaN for an empty piece.
/// @param labels  32SC1
/// @param image   32FC1
std::vector<double> medians(const cv::Mat& labels, const cv::Mat& image, int pieces);

}  // namespace raven_correction
