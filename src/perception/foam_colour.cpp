// SPDX-License-Identifier: BSD-3-Clause
#include "foam_colour.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <opencv2/imgproc.hpp>
#include <vector>

namespace raven_correction {
namespace {

constexpr float kFloor = 6.0f;  // e: noise of a dark pixel, of 255
constexpr double kBlur = 0.8;   // [px]
constexpr int kSampleStep = 3;  // of pixels that a median is taken of, along both axes

double median(std::vector<float>& values) {
  if (values.empty()) return std::numeric_limits<double>::quiet_NaN();
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// Median over the pixels of the field whose redness is above `limit`; NaN if there is none.
double medianAbove(const cv::Mat& redness, const cv::Mat& field, double limit) {
  std::vector<float> values;
  for (int v = 0; v < redness.rows; v += kSampleStep) {
    const float* const row = redness.ptr<float>(v);
    const std::uint8_t* const inside = field.ptr<std::uint8_t>(v);
    for (int u = 0; u < redness.cols; u += kSampleStep)
      if (inside[u] != 0 && row[u] > limit) values.push_back(row[u]);
  }
  return median(values);
}

}  // namespace

cv::Mat redness(const cv::Mat& image) {
  static const std::array<float, 256> logarithm = [] {
    std::array<float, 256> table{};
    for (std::size_t i = 0; i < table.size(); ++i)
      table[i] = std::log(static_cast<float>(i) + kFloor);
    return table;
  }();
  cv::Mat smooth;
  cv::GaussianBlur(image, smooth, cv::Size(), kBlur);
  cv::Mat result(image.size(), CV_32FC1);
  for (int v = 0; v < smooth.rows; ++v) {
    const cv::Vec3b* const pixel = smooth.ptr<cv::Vec3b>(v);
    float* const row = result.ptr<float>(v);
    for (int u = 0; u < smooth.cols; ++u)
      row[u] = logarithm[pixel[u][2]] - 0.5f * (logarithm[pixel[u][0]] + logarithm[pixel[u][1]]);
  }
  return result;
}

cv::Mat foamMask(const cv::Mat& redness, const cv::Mat& field, double redness_min,
                 double area_min) {
  const double tissue = medianAbove(redness, field, -std::numeric_limits<double>::infinity());
  const double foam = medianAbove(redness, field, tissue + redness_min);
  cv::Mat mask = cv::Mat::zeros(redness.size(), CV_8UC1);
  if (!std::isfinite(tissue) || !std::isfinite(foam)) return mask;
  const double limit = std::max(tissue + redness_min, 0.5 * (tissue + foam));
  cv::Mat red = (redness > limit) & field;
  cv::morphologyEx(red, red, cv::MORPH_OPEN, cv::getStructuringElement(cv::MORPH_ELLIPSE, {3, 3}));
  std::vector<std::vector<cv::Point>> contours;
  std::vector<cv::Vec4i> hierarchy;  // next, previous, first hole, parent
  cv::findContours(red, contours, hierarchy, cv::RETR_CCOMP, cv::CHAIN_APPROX_NONE);
  for (std::size_t i = 0; i < contours.size(); ++i) {
    if (hierarchy[i][3] >= 0 || cv::contourArea(contours[i]) < area_min) continue;
    cv::drawContours(mask, contours, static_cast<int>(i), cv::Scalar(255), cv::FILLED);
    for (int hole = hierarchy[i][2]; hole >= 0; hole = hierarchy[static_cast<std::size_t>(hole)][0])
      if (cv::contourArea(contours[static_cast<std::size_t>(hole)]) >= area_min)
        cv::drawContours(mask, contours, hole, cv::Scalar(0), cv::FILLED);
  }
  return mask;
}

}  // namespace raven_correction
