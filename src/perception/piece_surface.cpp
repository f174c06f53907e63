// SPDX-License-Identifier: BSD-3-Clause
#include "piece_surface.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>

namespace raven_correction {
namespace {

constexpr double kOutlier = 0.001;    // from the plane [m]
constexpr double kTiltPrior = 200.0;  // few pixels say little about a tilt [px^2]
constexpr double kFewest = 20.0;      // pixels for a plane

}  // namespace

double medianOf(std::vector<float>& values) {
  if (values.empty()) return std::numeric_limits<double>::quiet_NaN();
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

std::vector<double> medians(const cv::Mat& labels, const cv::Mat& image, int pieces) {
  std::vector<std::vector<float>> values(static_cast<std::size_t>(pieces) + 1);
  for (int v = 0; v < labels.rows; ++v)
    for (int u = 0; u < labels.cols; ++u) {
      const int label = labels.at<int>(v, u);
      const float value = image.at<float>(v, u);
      if (label > 0 && std::isfinite(value))
        values[static_cast<std::size_t>(label)].push_back(value);
    }
  std::vector<double> result;
  for (std::vector<float>& list : values) result.push_back(medianOf(list));
  return result;
}

PieceSurface fitSurface(const std::vector<cv::Point>& pixels, const cv::Mat& height) {
  PieceSurface surface;
  if (pixels.empty()) return surface;
  surface.origin = pixels[pixels.size() / 2];
  std::vector<float> values;
  for (const cv::Point& p : pixels) values.push_back(height.at<float>(p));
  surface.c.z() = medianOf(values);
  for (int round = 0; round < 3; ++round) {
    Eigen::Matrix3d H = Eigen::Matrix3d::Zero();
    Eigen::Vector3d g = Eigen::Vector3d::Zero();
    for (const cv::Point& p : pixels) {
      const double h = height.at<float>(p);
      if (!(std::abs(h - surface.at(p.x, p.y)) < (round == 0 ? 2.0 : 1.0) * kOutlier)) continue;
      const Eigen::Vector3d x(p.x - surface.origin.x, p.y - surface.origin.y, 1.0);
      H += x * x.transpose();
      g += h * x;
    }
    if (H(2, 2) < kFewest) break;
    H(0, 0) += kTiltPrior;
    H(1, 1) += kTiltPrior;
    surface.c = H.ldlt().solve(g);
  }
  return surface;
}

}  // namespace raven_correction
