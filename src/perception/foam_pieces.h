// SPDX-License-Identifier: BSD-3-Clause
// Which red pixels belong to which fragment, where fragments touch and overlap. In the left image
// the pieces are found; in the right one they are found again, from where the left ones must be.
#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "foam_colour.h"
#include "height_map.h"
#include "piece_joiner.h"

namespace raven_correction {

/// Foam cut into small pieces along what could be borders: a watershed from one core per cell of
/// a grid. Every border between fragments is one between pieces; most borders between pieces are
/// none.
/// @param mask    8UC1: foam
/// @param height  32FC1, heightMap() [m]
/// @return 32SC1: 0 no foam, otherwise the number of the piece from 1; their count in `pieces`
cv::Mat cutIntoPieces(const FoamColour& colour, const cv::Mat& mask, const cv::Mat& height,
                      int& pieces);

/// cutIntoPieces(), what belongs together joined (PieceJoiner), and the borders between pieces of
/// different colours moved to where the colour changes.
cv::Mat splitFoam(const FoamColour& colour, const cv::Mat& mask, const cv::Mat& height,
                  const PieceLimits& limits);

/// The same pieces in the right image: each left piece moved along its rows as the plane through
/// its heights says, the lower ones first, and between those a watershed within the mask. A piece
/// that is not seen keeps no pixel.
cv::Mat transferPieces(const cv::Mat& left_labels, const FoamColour& left_colour,
                       const cv::Mat& height, const FoamColour& right_colour,
                       const cv::Mat& right_mask, const PlaneSweep& sweep);

/// Which piece hides a part of which: element [a][b] says that b lies in front of a. On one line of
/// sight the nearer point is the higher one, so b is higher than a where they meet.
/// @return one more row and column than there are pieces; the first of each is not used
std::vector<std::vector<bool>> findOcclusions(const cv::Mat& labels, const cv::Mat& height,
                                              int pieces);

}  // namespace raven_correction
