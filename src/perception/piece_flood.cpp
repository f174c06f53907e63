// SPDX-License-Identifier: BSD-3-Clause
#include "piece_flood.h"

#include <algorithm>
#include <array>
#include <map>
#include <opencv2/imgproc.hpp>
#include <vector>

namespace raven_correction {
namespace {

constexpr int kStrip = 7;  // width of what is no piece of its own [px]

}  // namespace

void flood(const cv::Mat& relief, const cv::Mat& mask, cv::Mat& labels) {
  // One queue per level; a pixel below the current level is treated as if it were on it.
  std::array<std::vector<cv::Point>, 256> queues;
  const auto pushNeighbours = [&](const cv::Point p, int level) {
    for (const auto& [dv, du] : {std::pair{0, -1}, {-1, 0}, {0, 1}, {1, 0}}) {
      const cv::Point q(p.x + du, p.y + dv);
      if (q.x < 0 || q.y < 0 || q.x >= labels.cols || q.y >= labels.rows) continue;
      if (mask.at<std::uint8_t>(q) == 0 || labels.at<int>(q) != 0) continue;
      labels.at<int>(q) = labels.at<int>(p);
      queues[static_cast<std::size_t>(std::max<int>(level, relief.at<std::uint8_t>(q)))].push_back(
          q);
    }
  };
  for (int v = 0; v < labels.rows; ++v)
    for (int u = 0; u < labels.cols; ++u)
      if (labels.at<int>(v, u) > 0) queues[0].emplace_back(u, v);
  for (std::size_t level = 0; level < queues.size(); ++level)
    for (std::size_t i = 0; i < queues[level].size(); ++i)
      pushNeighbours(queues[level][i], static_cast<int>(level));
}

void giveStripsBack(const cv::Mat& mask, cv::Mat& labels) {
  double last = 0.0;
  cv::minMaxLoc(labels, nullptr, &last);
  const cv::Mat disc = cv::getStructuringElement(cv::MORPH_ELLIPSE, {kStrip, kStrip});
  cv::Mat wide = cv::Mat::zeros(labels.size(), CV_32SC1);
  for (int k = 1; k <= static_cast<int>(last); ++k) {
    const cv::Mat piece = labels == k;
    cv::Rect box = cv::boundingRect(piece);
    if (box.empty()) continue;
    cv::Mat opened;
    cv::copyMakeBorder(piece(box), opened, kStrip, kStrip, kStrip, kStrip, cv::BORDER_CONSTANT,
                       cv::Scalar(0));
    cv::morphologyEx(opened, opened, cv::MORPH_OPEN, disc);
    wide(box).setTo(k, opened(cv::Rect(kStrip, kStrip, box.width, box.height)));
  }
  if (cv::countNonZero(wide) == 0) return;
  cv::Mat distance;
  cv::Mat nearest;  // number of the nearest pixel of `wide`
  cv::distanceTransform(wide == 0, distance, nearest, cv::DIST_L2, cv::DIST_MASK_5,
                        cv::DIST_LABEL_PIXEL);
  std::vector<int> piece_of(labels.total() + 1, 0);
  for (int v = 0; v < labels.rows; ++v)
    for (int u = 0; u < labels.cols; ++u)
      if (wide.at<int>(v, u) > 0)
        piece_of[static_cast<std::size_t>(nearest.at<int>(v, u))] = wide.at<int>(v, u);
  for (int v = 0; v < labels.rows; ++v)
    for (int u = 0; u < labels.cols; ++u)
      if (mask.at<std::uint8_t>(v, u) != 0 && labels.at<int>(v, u) != 0)
        labels.at<int>(v, u) = piece_of[static_cast<std::size_t>(nearest.at<int>(v, u))];
}

int renumber(cv::Mat& labels) {
  std::map<int, int> numbers;
  for (int v = 0; v < labels.rows; ++v)
    for (int u = 0; u < labels.cols; ++u) {
      int& label = labels.at<int>(v, u);
      if (label != 0)
        label = numbers.emplace(label, static_cast<int>(numbers.size()) + 1).first->second;
    }
  return static_cast<int>(numbers.size());
}

}  // namespace raven_correction
