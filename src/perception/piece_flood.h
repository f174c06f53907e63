// SPDX-License-Identifier: BSD-3-Clause
// Regions that grow until they meet: the watershed, and what tidies up after it. Which regions are
// one fragment is piece_joiner.h.
#pragma once

#include <opencv2/core.hpp>

namespace raven_correction {

/// Watershed within a mask: labels grow over pixels of low relief first, and every pixel of the
/// mask that is connected to a label gets one.
/// @param relief  8UC1
/// @param labels  32SC1: markers from 1; is changed
void flood(const cv::Mat& relief, const cv::Mat& mask, cv::Mat& labels);

/// The side of a fragment is darker or brighter than its top, and a neighbour floods along it:
/// parts of a piece that are narrow go to whatever piece is nearest.
void giveStripsBack(const cv::Mat& mask, cv::Mat& labels);

/// Numbers from 1 without gaps.
/// @return the last number
int renumber(cv::Mat& labels);

}  // namespace raven_correction
