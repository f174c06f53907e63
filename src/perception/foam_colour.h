// SPDX-License-Identifier: BSD-3-Clause
// Which pixels have the colour of red foam, whatever the light, and which red it is. Which of them
// belong together is foam_pieces.h.
#pragma once

#include <opencv2/core.hpp>

namespace raven_correction {

/// log((R + e) / sqrt((G + e) (B + e))) of a slightly blurred image, e = 6 of 255: independent of
/// brightness above the noise.
/// @param image  8UC3, blue green red
/// @return 32FC1
cv::Mat redness(const cv::Mat& image);

/// The pixels that are red: above a limit half way between the median of the field (tissue) and the
/// median of what is clearly red, and at least `redness_min` above the former.
/// @param field     8UC1, where to look
/// @param area_min  smaller regions and holes do not count [px]
/// @return 8UC1, 255 or 0
cv::Mat foamMask(const cv::Mat& redness, const cv::Mat& field, double redness_min, double area_min);

/// Light and colour of the foam, pixel by pixel. Every piece of foam has its own two ratios of
/// green and blue to red, which light and shadow hardly change; ratios are taken of means of linear
/// light, because a dark pixel alone has hardly any.
struct FoamColour {
  cv::Mat light;       ///< 32FC3: linear, [0, 1]; 0 outside the mask and where red is saturated
  cv::Mat brightness;  ///< 32FC1: logarithm of linear light, smoothed [-]
  cv::Mat green;       ///< 32FC1: log(G / R) of means over about 5 px within the mask
  cv::Mat blue;        ///< 32FC1: log(B / R), likewise
};
/// @param image  8UC3, blue green red, encoded as sRGB
/// @param mask   8UC1; what lies outside does not count
FoamColour foamColour(const cv::Mat& image, const cv::Mat& mask);

}  // namespace raven_correction
