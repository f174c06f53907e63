// SPDX-License-Identifier: BSD-3-Clause
#include "foam_marks.h"

#include <algorithm>
#include <opencv2/imgproc.hpp>
#include <vector>

namespace raven_correction {
namespace {

// So high a mark may seem, per thickness_min: in 800 rendered scenes regions of foam, 3 mm thick or
// more, seemed 0.4 mm high or more, and 0.7 mm where they were too small for a fragment and half of
// another.
constexpr double kMark = 0.117;
constexpr double kSmallMark = 0.217;
constexpr double kConvex = 0.93;  // share of its convex hull that a region of one fragment fills
constexpr int kSurround = 11;     // twice what is looked at around a region [px]

/// Whether a region fills its convex hull, as one piece of cut foam does. What is spilt seldom
/// does.
bool isConvex(const cv::Mat& region) {
  std::vector<std::vector<cv::Point>> contours;
  cv::findContours(region, contours, cv::RETR_EXTERNAL, cv::CHAIN_APPROX_NONE);
  const auto longest =
      std::max_element(contours.begin(), contours.end(),
                       [](const auto& a, const auto& b) { return a.size() < b.size(); });
  std::vector<cv::Point> hull;
  cv::convexHull(*longest, hull);
  return cv::contourArea(*longest) >= kConvex * cv::contourArea(hull);
}

}  // namespace

void removeMarks(const cv::Mat& left_redness, const cv::Mat& right_redness, const PlaneSweep& sweep,
                 const MarkLimits& limits, cv::Mat& mask) {
  cv::Mat regions;
  const int n = cv::connectedComponents(mask, regions, 8, CV_32S);
  const cv::Mat disc = cv::getStructuringElement(cv::MORPH_ELLIPSE, {kSurround, kSurround});
  for (int k = 1; k < n; ++k) {
    const cv::Mat region = regions == k;
    const bool small = cv::countNonZero(region) < 1.5 * limits.area_whole;
    cv::Mat with_surroundings;
    cv::dilate(region, with_surroundings, disc);
    const double height =
        regionHeight(left_redness, right_redness, with_surroundings, sweep, limits.height_max);
    const bool flat =
        height < std::min((small ? kSmallMark : kMark) * limits.thickness_min, limits.height_min);
    if (flat || (small && !isConvex(region))) mask.setTo(0, region);
  }
}

}  // namespace raven_correction
