// SPDX-License-Identifier: BSD-3-Clause
// Detections drawn into the rectified left image, for people.
#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "raven_correction/perception/fragment_detector.h"

namespace raven_correction {

/// Around each detection the outline of what is seen (dashed if something lies on it), a cross at
/// its centre, its long axis, and its number from 1 in the order of the list.
/// @param image  8UC3, rectified, left; is drawn on
void drawDetections(const std::vector<FragmentDetection>& detections, cv::Mat& image);

/// Every piece of foam in a colour of its own, half transparent.
/// @param labels  32SC1, of FragmentDetectorTrace
/// @param image   8UC3, of the same size; is drawn on
void drawPieces(const cv::Mat& labels, cv::Mat& image);

}  // namespace raven_correction
