// SPDX-License-Identifier: BSD-3-Clause
// Which red regions are no foam but marks on the platform, e.g. blood: they have no height, or not
// the shape of a cut piece. Which foam belongs together is foam_pieces.h.
#pragma once

#include <opencv2/core.hpp>

#include "height_map.h"

namespace raven_correction {

struct MarkLimits {
  double area_whole = 0.0;     ///< of a whole fragment, the smallest there is [px^2]
  double thickness_min = 0.0;  ///< of a fragment as it lies flat [m]
  double height_min = 0.0;     ///< of a fragment's centre above the platform [m]
  double height_max = 0.0;     ///< heights are looked for up to it [m]
};

/// A region whose outline lies on the platform is a mark. One height for foam and what surrounds it
/// lies between the platform and the foam. A region that is too small for a fragment and half of
/// another is a mark, too, if it does not fill its convex hull.
/// @param left_redness, right_redness  32FC1, rectified (foam_colour.h)
/// @param mask  8UC1, 255 where the left image is red; marks become 0
void removeMarks(const cv::Mat& left_redness, const cv::Mat& right_redness, const PlaneSweep& sweep,
                 const MarkLimits& limits, cv::Mat& mask);

}  // namespace raven_correction
