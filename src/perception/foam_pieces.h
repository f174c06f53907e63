// SPDX-License-Identifier: BSD-3-Clause
// Which red pixels belong to which fragment, where fragments touch and overlap. In the left image
// the pieces are found; in the right one they are found again, from where the left ones must be.
#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "height_map.h"

namespace raven_correction {

struct PieceLimits {
  double pixels_per_metre = 4000.0;
  double radius_min = 0.0009;  ///< of the largest disc inside a piece [m]
  double length_max = 0.016;   ///< [m]
};

/// @param image    8UC3, rectified
/// @param redness  32FC1, redness() of it
/// @param mask     8UC1: foam
/// @param height   32FC1, heightMap() [m]
/// @return 32SC1: 0 no foam, otherwise the number of the piece from 1
cv::Mat splitFoam(const cv::Mat& image, const cv::Mat& redness, const cv::Mat& mask,
                  const cv::Mat& height, const PieceLimits& limits);

/// The same pieces in the right image: each left piece moved along its rows as the plane through
/// its heights says, the lower ones first, and between those a watershed within the mask. A piece
/// that is not seen keeps no pixel.
cv::Mat transferPieces(const cv::Mat& left_labels, const cv::Mat& height, const cv::Mat& right,
                       const cv::Mat& right_mask, const PlaneSweep& sweep);

/// Which piece hides a part of which: element [a][b] says that b lies in front of a. On one line of
/// sight the nearer point is the higher one, so b is higher than a where they meet.
/// @return one more row and column than there are pieces; the first of each is not used
std::vector<std::vector<bool>> findOcclusions(const cv::Mat& labels, const cv::Mat& height,
                                              int pieces);

/// Median over the pixels of each piece; element 0 is not used. NaN for an empty piece.
/// @param image  32FC1
std::vector<double> medians(const cv::Mat& labels, const cv::Mat& image, int pieces);

}  // namespace raven_correction
