// SPDX-License-Identifier: BSD-3-Clause
#include "height_map.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <opencv2/imgproc.hpp>
#include <vector>

namespace raven_correction {
namespace {

constexpr double kLowest = -0.001;  // [m]
constexpr double kStep = 0.0005;    // between planes [m]
constexpr int kWindow = 5;          // over which differences are summed [px]
constexpr double kMeanBlur = 3.5;   // of the local mean [px]
// Of the smoothness, in units of the usual difference of a right match: one plane up or down from
// one pixel to the next, and a jump.
constexpr float kSlopeCost = 0.35f;
constexpr float kJumpCost = 1.6f;
constexpr float kLargestCost = 6.0f;  // of a pixel, in the same unit

constexpr double kLowestRegion = -0.002;    // [m]
constexpr double kRegionStep = 0.0001;      // [m]
constexpr double kLargestDifference = 0.5;  // of redness

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

/// Costs of all planes for the pixels of a mask, and their sum along paths.
class Matching {
 public:
  Matching(const cv::Mat& mask, int levels)
      : levels_(levels), index_(mask.size(), CV_32SC1, cv::Scalar(-1)) {
    for (int v = 0; v < mask.rows; ++v)
      for (int u = 0; u < mask.cols; ++u)
        if (mask.at<std::uint8_t>(v, u) != 0) {
          index_.at<int>(v, u) = static_cast<int>(pixels.size());
          pixels.emplace_back(u, v);
        }
    costs_.resize(pixels.size() * static_cast<std::size_t>(levels));
    sums_.assign(costs_.size(), 0.0f);
  }
  float* costs(std::size_t pixel) { return costs_.data() + pixel * stride(); }
  const float* sums(std::size_t pixel) const { return sums_.data() + pixel * stride(); }

  /// Divides all costs by the median of the best ones and limits them.
  void normalise() {
    std::vector<float> best;
    for (std::size_t i = 0; i < pixels.size(); ++i)
      best.push_back(*std::min_element(costs(i), costs(i) + levels_));
    const auto middle = best.begin() + static_cast<std::ptrdiff_t>(best.size() / 2);
    std::nth_element(best.begin(), middle, best.end());
    const float scale = 1.0f / std::max(*middle, 1e-3f);
    for (float& cost : costs_) cost = std::min(cost * scale, kLargestCost);
  }

  /// Adds the least cost of getting to every pixel and plane along a path of one direction.
  void addPath(int du, int dv) {
    std::vector<float> path(costs_.size());
    std::vector<float> least(pixels.size());
    const bool forward = dv > 0 || (dv == 0 && du > 0);
    for (std::size_t n = 0; n < pixels.size(); ++n) {
      const std::size_t i = forward ? n : pixels.size() - 1 - n;
      const cv::Point before = pixels[i] - cv::Point(du, dv);
      const bool inside =
          before.x >= 0 && before.y >= 0 && before.x < index_.cols && before.y < index_.rows;
      const int from = inside ? index_.at<int>(before) : -1;
      const float* const cost = costs(i);
      float* const out = path.data() + i * stride();
      if (from < 0) {
        std::copy(cost, cost + levels_, out);
      } else {
        const float* const last = path.data() + static_cast<std::size_t>(from) * stride();
        const float base = least[static_cast<std::size_t>(from)];
        for (int k = 0; k < levels_; ++k) {
          float way = std::min(last[k], base + kJumpCost);
          if (k > 0) way = std::min(way, last[k - 1] + kSlopeCost);
          if (k + 1 < levels_) way = std::min(way, last[k + 1] + kSlopeCost);
          out[k] = cost[k] + way - base;
        }
      }
      least[i] = *std::min_element(out, out + levels_);
      float* const sum = sums_.data() + i * stride();
      for (int k = 0; k < levels_; ++k) sum[k] += out[k];
    }
  }

  std::vector<cv::Point> pixels;

 private:
  std::size_t stride() const { return static_cast<std::size_t>(levels_); }
  int levels_;
  cv::Mat index_;  // 32SC1: of a pixel in `pixels`, or -1
  std::vector<float> costs_;
  std::vector<float> sums_;
};

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
  const cv::Rect box = cv::boundingRect(left_mask);
  if (box.empty()) return result;
  const cv::Mat left_texture = texture(left, left_mask);
  const cv::Mat right_texture = texture(right, right_mask);
  const int levels = static_cast<int>(std::ceil((height_max - kLowest) / kStep)) + 1;
  const cv::Size window(kWindow, kWindow);
  Matching matching(left_mask, levels);
  cv::Mat count;
  cv::boxFilter(left_mask(box), count, CV_32F, window, {-1, -1}, false, cv::BORDER_CONSTANT);
  count /= 255.0;
  cv::Mat difference(box.size(), CV_32FC1);
  cv::Mat sum;
  for (int k = 0; k < levels; ++k) {
    const double height = kLowest + k * kStep;
    difference.setTo(0.0);
    for (const cv::Point& p : matching.pixels) {
      const double there = sweep.rightColumn(p.x, p.y, height);
      const int first = static_cast<int>(std::floor(there));
      float value = 0.0f;
      if (first >= 0 && first + 1 < right.cols) {
        const float* const theirs = right_texture.ptr<float>(p.y);
        const auto s = static_cast<float>(there - first);
        value = theirs[first] + s * (theirs[first + 1] - theirs[first]);
      }
      difference.at<float>(p - box.tl()) = std::abs(left_texture.at<float>(p) - value);
    }
    cv::boxFilter(difference, sum, CV_32F, window, {-1, -1}, false, cv::BORDER_CONSTANT);
    for (std::size_t i = 0; i < matching.pixels.size(); ++i) {
      const cv::Point q = matching.pixels[i] - box.tl();
      matching.costs(i)[k] = sum.at<float>(q) / count.at<float>(q);
    }
  }
  matching.normalise();
  for (const auto& [du, dv] :
       {std::pair{1, 0}, {-1, 0}, {0, 1}, {0, -1}, {1, 1}, {-1, -1}, {1, -1}, {-1, 1}})
    matching.addPath(du, dv);
  for (std::size_t i = 0; i < matching.pixels.size(); ++i) {
    const float* const sums = matching.sums(i);
    const auto best = std::min_element(sums, sums + levels) - sums;
    double fine = 0.0;  // vertex of the parabola through three levels
    if (best > 0 && best + 1 < levels) {
      const double bend = sums[best - 1] - 2.0 * sums[best] + sums[best + 1];
      if (bend > 0.0) fine = 0.5 * (sums[best - 1] - sums[best + 1]) / bend;
    }
    result.at<float>(matching.pixels[i]) =
        static_cast<float>(kLowest + (static_cast<double>(best) + fine) * kStep);
  }
  return result;
}

double regionHeight(const cv::Mat& left_redness, const cv::Mat& right_redness,
                    const cv::Mat& region, const PlaneSweep& sweep, double height_max) {
  std::vector<cv::Point> pixels;
  cv::findNonZero(region, pixels);
  const int levels = static_cast<int>(std::ceil((height_max - kLowestRegion) / kRegionStep)) + 1;
  std::vector<double> sums;
  for (int k = 0; k < levels; ++k) {
    const double height = kLowestRegion + k * kRegionStep;
    double sum = 0.0;
    for (const cv::Point& p : pixels) {
      const double there = sweep.rightColumn(p.x, p.y, height);
      const int first = static_cast<int>(std::floor(there));
      double difference = kLargestDifference;
      if (first >= 0 && first + 1 < right_redness.cols) {
        const float* const row = right_redness.ptr<float>(p.y);
        const double value = row[first] + (there - first) * (row[first + 1] - row[first]);
        difference = std::min(difference, std::abs(left_redness.at<float>(p) - value));
      }
      sum += difference;
    }
    sums.push_back(sum);
  }
  const auto best = std::min_element(sums.begin(), sums.end()) - sums.begin();
  return kLowestRegion + static_cast<double>(best) * kRegionStep;
}

}  // namespace raven_correction
