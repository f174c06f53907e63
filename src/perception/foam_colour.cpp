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

constexpr float kFloor = 6.0f;             // e: noise of a dark pixel, of 255
constexpr double kBlur = 0.8;              // [px]
constexpr int kSampleStep = 3;             // of pixels that a median is taken of, along both axes
constexpr int kSaturated = 247;            // level of red above which it is not known
constexpr float kSaturatedWeight = 0.02f;  // counts only where nothing else is known
constexpr double kColourBlur = 1.8;        // [px]
constexpr double kBrightnessBlur = 1.2;    // [px]
constexpr float kDark = 2e-3f;             // linear light that cannot be told from none

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

/// Linear light of an sRGB level.
const std::array<float, 256>& decoding() {
  static const std::array<float, 256> table = [] {
    std::array<float, 256> values{};
    for (std::size_t i = 0; i < values.size(); ++i) {
      const double y = static_cast<double>(i) / 255.0;
      values[i] = static_cast<float>(y <= 0.04045 ? y / 12.92 : std::pow((y + 0.055) / 1.055, 2.4));
    }
    return values;
  }();
  return table;
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

FoamColour foamColour(const cv::Mat& image, const cv::Mat& mask) {
  const std::array<float, 256>& linear = decoding();
  FoamColour colour;
  colour.light = cv::Mat::zeros(image.size(), CV_32FC3);
  cv::Mat sum(image.size(), CV_32FC1);
  cv::Mat weighted = cv::Mat::zeros(image.size(), CV_32FC3);
  cv::Mat weight = cv::Mat::zeros(image.size(), CV_32FC1);
  for (int v = 0; v < image.rows; ++v) {
    const cv::Vec3b* const pixel = image.ptr<cv::Vec3b>(v);
    const std::uint8_t* const inside = mask.ptr<std::uint8_t>(v);
    for (int u = 0; u < image.cols; ++u) {
      const cv::Vec3f light(linear[pixel[u][0]], linear[pixel[u][1]], linear[pixel[u][2]]);
      sum.at<float>(v, u) = light[0] + light[1] + light[2];
      if (inside[u] == 0) continue;
      const bool known = pixel[u][2] <= kSaturated;
      if (known) colour.light.at<cv::Vec3f>(v, u) = light;
      weight.at<float>(v, u) = known ? 1.0f : kSaturatedWeight;
      weighted.at<cv::Vec3f>(v, u) = weight.at<float>(v, u) * light;
    }
  }
  cv::GaussianBlur(sum, sum, cv::Size(), kBrightnessBlur);
  cv::log(sum + kDark, colour.brightness);
  cv::Mat mean;  // weighted sums over the neighbours: the weight cancels in the ratios
  cv::GaussianBlur(weighted, mean, cv::Size(), kColourBlur);
  cv::GaussianBlur(weight, weight, cv::Size(), kColourBlur);
  colour.green = cv::Mat::zeros(image.size(), CV_32FC1);
  colour.blue = cv::Mat::zeros(image.size(), CV_32FC1);
  for (int v = 0; v < image.rows; ++v)
    for (int u = 0; u < image.cols; ++u) {
      if (mask.at<std::uint8_t>(v, u) == 0) continue;
      const cv::Vec3f& m = mean.at<cv::Vec3f>(v, u);
      const float floor = kDark * weight.at<float>(v, u);
      colour.green.at<float>(v, u) = std::log((m[1] + floor) / (m[2] + floor));
      colour.blue.at<float>(v, u) = std::log((m[0] + floor) / (m[2] + floor));
    }
  return colour;
}

}  // namespace raven_correction
