// SPDX-License-Identifier: BSD-3-Clause
#include "height_map.h"

#include <cmath>
#include <limits>
#include <opencv2/imgproc.hpp>
#include <vector>

namespace raven_correction {
namespace {

constexpr double kLowest = -0.001;  // [m]
constexpr double kStep = 0.0005;    // between planes [m]
constexpr int kWindow = 9;          // [px]
constexpr double kMeanBlur = 3.5;   // of the local mean [px]

/// Brightness less its mean over the foam around, and 0 outside the mask.
cv::Mat texture(const cv::Mat& image, const cv::Mat& mask) {
  cv::Mat grey(image.size(), CV_32FC1);
  cv::Mat weight(image.size(), CV_32FC1);
  for (int v = 0; v < image.rows; ++v) {
    const cv::Vec3b* const pixel = image.ptr<cv::Vec3b>(v);
    const std::uint8_t* const inside = mask.ptr<std::uint8_t>(v);
    float* const g = grey.ptr<float>(v);
    float* const w = weight.ptr<float>(v);
    for (int u = 0; u < image.cols; ++u) {
      w[u] = inside[u] != 0 ? 1.0f : 0.0f;
      g[u] = w[u] * static_cast<float>(pixel[u][0] + pixel[u][1] + pixel[u][2]);
    }
  }
  cv::Mat mean;
  cv::Mat share;
  cv::GaussianBlur(grey, mean, cv::Size(), kMeanBlur);
  cv::GaussianBlur(weight, share, cv::Size(), kMeanBlur);
  cv::Mat quotient;
  cv::divide(mean, cv::max(share, 1e-3f), quotient);
  cv::subtract(grey, quotient, grey, mask);
  return grey;
}

}  // namespace

PlaneSweep::PlaneSweep(const StereoCamera& camera, const Pose& X_field_camera) {
  const auto& P = camera.left.P;
  const Eigen::Vector3d row = X_field_camera.q.toRotationMatrix().row(2);
  normal_ = {row.x() / P(0, 0), row.y() / P(1, 1),
             row.z() - row.x() * P(0, 2) / P(0, 0) - row.y() * P(1, 2) / P(1, 1)};
  shift_ = camera.right.P(0, 2) - P(0, 2);
  scale_ = P(0, 0) * camera.baseline();
  camera_height_ = X_field_camera.p.z();
}

double PlaneSweep::rightColumn(double u, double v, double height) const noexcept {
  return u + shift_ + scale_ * normal_.dot(Eigen::Vector3d(u, v, 1.0)) / (camera_height_ - height);
}

double PlaneSweep::columnsPerMetre(double u, double v, double height) const noexcept {
  const double gap = camera_height_ - height;
  return scale_ * normal_.dot(Eigen::Vector3d(u, v, 1.0)) / (gap * gap);
}

cv::Mat heightMap(const cv::Mat& left, const cv::Mat& right, const cv::Mat& left_mask,
                  const cv::Mat& right_mask, const PlaneSweep& sweep, double height_max) {
  cv::Mat result(left.size(), CV_32FC1, cv::Scalar(std::numeric_limits<float>::quiet_NaN()));
  cv::Rect box = cv::boundingRect(left_mask);
  if (box.empty()) return result;
  const cv::Mat left_texture = texture(left, left_mask);
  const cv::Mat right_texture = texture(right, right_mask);
  const int levels = static_cast<int>(std::ceil((height_max - kLowest) / kStep)) + 1;
  const cv::Size window(kWindow, kWindow);
  cv::Mat count;
  cv::boxFilter(left_mask(box), count, CV_32F, window, {-1, -1}, false, cv::BORDER_CONSTANT);
  std::vector<cv::Mat> costs;
  cv::Mat difference(box.size(), CV_32FC1);
  for (int k = 0; k < levels; ++k) {
    const double height = kLowest + k * kStep;
    difference.setTo(0.0);
    for (int v = 0; v < box.height; ++v) {
      const int row = box.y + v;
      const std::uint8_t* const inside = left_mask.ptr<std::uint8_t>(row);
      const float* const ours = left_texture.ptr<float>(row);
      const float* const theirs = right_texture.ptr<float>(row);
      float* const out = difference.ptr<float>(v);
      for (int u = 0; u < box.width; ++u) {
        const int column = box.x + u;
        if (inside[column] == 0) continue;
        const double there = sweep.rightColumn(column, row, height);
        const int first = static_cast<int>(std::floor(there));
        float value = 0.0f;
        if (first >= 0 && first + 1 < right.cols) {
          const auto s = static_cast<float>(there - first);
          value = theirs[first] + s * (theirs[first + 1] - theirs[first]);
        }
        out[u] = std::abs(ours[column] - value);
      }
    }
    cv::Mat cost;
    cv::boxFilter(difference, cost, CV_32F, window, {-1, -1}, false, cv::BORDER_CONSTANT);
    costs.push_back(cost);
  }
  for (int v = 0; v < box.height; ++v)
    for (int u = 0; u < box.width; ++u) {
      if (left_mask.at<std::uint8_t>(box.y + v, box.x + u) == 0) continue;
      int best = 0;
      for (int k = 1; k < levels; ++k)
        if (costs[static_cast<std::size_t>(k)].at<float>(v, u) <
            costs[static_cast<std::size_t>(best)].at<float>(v, u))
          best = k;
      double fine = 0.0;  // vertex of the parabola through three levels
      if (best > 0 && best + 1 < levels) {
        const auto at = [&](int k) {
          return static_cast<double>(costs[static_cast<std::size_t>(k)].at<float>(v, u));
        };
        const double bend = at(best - 1) - 2.0 * at(best) + at(best + 1);
        if (bend > 0.0) fine = 0.5 * (at(best - 1) - at(best + 1)) / bend;
      }
      result.at<float>(box.y + v, box.x + u) = static_cast<float>(kLowest + (best + fine) * kStep);
    }
  return result;
}

}  // namespace raven_correction
