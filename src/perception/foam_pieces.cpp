// SPDX-License-Identifier: BSD-3-Clause
#include "foam_pieces.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <opencv2/imgproc.hpp>
#include <vector>

namespace raven_correction {
namespace {

constexpr double kSeamBlur = 1.2;  // before edges are looked for [px]
constexpr double kEdgeLow = 25.0;  // of a gradient in 8-bit logarithm of brightness
constexpr double kEdgeHigh = 60.0;
constexpr double kColourLow = 30.0;  // in redness, 100 levels per unit of logarithm
constexpr double kColourHigh = 55.0;
constexpr double kStepLow = 16.0;  // in height, 10 levels per mm
constexpr double kStepHigh = 32.0;
constexpr float kPersistence = 0.08f;   // of a core: how far its distance rises above the saddle
constexpr double kHeightStep = 0.0015;  // between two surfaces that are not one [m]
constexpr double kColourStep = 0.14;    // between the colours of two pieces, in logarithm
constexpr double kConcave = 0.80;       // area per area of the hull: certainly two
constexpr double kHollow = 0.05;        // by which two parts are more convex than both together
constexpr double kSeamDark = 0.16;      // logarithm by which a seam is darker than both sides
constexpr double kInFront = 0.0004;     // higher than the other along their seam [m]
constexpr int kSeamReach = 4;           // from the seam, where heights are compared [px]
constexpr float kUnsure = 2.5f;     // from the edge of a piece, where the right image decides [px]
constexpr double kOutlier = 0.001;  // from the plane of a piece [m]
constexpr double kTiltPrior = 200.0;  // [px^2]
constexpr double kUsualSize = 0.70;   // length of a fragment per length_max, at most
constexpr double kSizeSpread = 0.2;
constexpr int kStrip = 7;  // width of what is no piece of its own [px]

/// Logarithm of brightness as 8 bits, smoothed: a change of illumination is a step of equal size
/// wherever it happens. Half of it is red, which foam has most of; the rest still tells something
/// where red is overexposed.
cv::Mat logBrightness(const cv::Mat& image) {
  cv::Mat table(1, 256, CV_8UC1);
  for (int i = 0; i < 256; ++i)
    table.at<std::uint8_t>(i) = static_cast<std::uint8_t>(
        std::lround(255.0 * std::log((i + 8.0) / 8.0) / std::log(263.0 / 8.0)));
  cv::Mat levels;
  cv::LUT(image, table, levels);
  cv::Mat result;
  cv::transform(levels, result, cv::Matx13f(0.25f, 0.25f, 0.5f));
  cv::GaussianBlur(result, result, cv::Size(), kSeamBlur);
  return result;
}
const double kLevelsPerLog = 255.0 / std::log(263.0 / 8.0);

/// Edges of a 32FC1 image within the mask, made 8-bit by (value + offset) scale and smoothed.
cv::Mat edgesOf(const cv::Mat& values, const cv::Mat& mask, double scale, double offset, double low,
                double high) {
  cv::Mat known = values.clone();
  cv::patchNaNs(known, 0.0);
  cv::Mat levels;
  known.convertTo(levels, CV_8UC1, scale, offset * scale);
  levels.setTo(0, mask == 0);
  cv::medianBlur(levels, levels, 5);
  cv::GaussianBlur(levels, levels, cv::Size(), 1.0);
  cv::Mat edges;
  cv::Canny(levels, edges, low, high, 3, true);
  return edges;
}

/// Peaks of `distance` that rise above the saddle to a higher one by a share of their own height.
/// @return 32SC1 with one pixel per peak, numbered from 1; their count in `peaks`
cv::Mat findPeaks(const cv::Mat& distance, float lowest, int& peaks) {
  struct Pixel {
    float value;
    int index;
  };
  std::vector<Pixel> order;
  const int width = distance.cols;
  for (int v = 0; v < distance.rows; ++v)
    for (int u = 0; u < width; ++u)
      if (distance.at<float>(v, u) > 0.0f)
        order.push_back({distance.at<float>(v, u), v * width + u});
  std::stable_sort(order.begin(), order.end(),
                   [](const Pixel& a, const Pixel& b) { return a.value > b.value; });
  std::vector<int> parent(distance.total(), -1);  // of a basin; its root is its peak
  std::vector<char> kept(distance.total(), 0);
  const auto root = [&](int i) {
    while (parent[static_cast<std::size_t>(i)] != i) {
      int& up = parent[static_cast<std::size_t>(i)];
      up = parent[static_cast<std::size_t>(up)];
      i = up;
    }
    return i;
  };
  const auto valueAt = [&](int i) { return distance.at<float>(i / width, i % width); };
  for (const Pixel& pixel : order) {
    const int u = pixel.index % width;
    const int v = pixel.index / width;
    parent[static_cast<std::size_t>(pixel.index)] = pixel.index;
    kept[static_cast<std::size_t>(pixel.index)] = pixel.value >= lowest;
    for (int dv = -1; dv <= 1; ++dv)
      for (int du = -1; du <= 1; ++du) {
        if (u + du < 0 || v + dv < 0 || u + du >= width || v + dv >= distance.rows) continue;
        const int neighbour = (v + dv) * width + u + du;
        if (parent[static_cast<std::size_t>(neighbour)] < 0) continue;
        int high = root(neighbour);
        int low = root(pixel.index);
        if (high == low) continue;
        if (valueAt(high) < valueAt(low)) std::swap(high, low);
        // The saddle between both is here: the lower peak stays one if it stands out.
        if (valueAt(low) - pixel.value < std::max(0.5f, kPersistence * valueAt(low)))
          kept[static_cast<std::size_t>(low)] = 0;
        parent[static_cast<std::size_t>(low)] = high;
      }
  }
  cv::Mat labels = cv::Mat::zeros(distance.size(), CV_32SC1);
  peaks = 0;
  for (const Pixel& pixel : order)
    if (kept[static_cast<std::size_t>(pixel.index)])
      labels.at<int>(pixel.index / width, pixel.index % width) = ++peaks;
  return labels;
}

/// The side of a fragment is darker or brighter than its top, and a neighbour floods along it:
/// parts of a piece that are narrow go to whatever piece is nearest.
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

/// cv::watershed within a mask: `labels` holds markers from 1 and gets the pieces. The mask is one
/// of the channels, so that its edge is the highest ridge.
void flood(const cv::Mat& brightness, const cv::Mat& mask, cv::Mat& labels) {
  const cv::Mat channels[] = {brightness, brightness, mask};
  cv::Mat relief;
  cv::merge(channels, 3, relief);
  cv::Mat markers = labels.clone();
  const int outside = 1 << 28;
  cv::Mat far;
  cv::dilate(mask, far, cv::getStructuringElement(cv::MORPH_RECT, {3, 3}));
  markers.setTo(outside, far == 0);
  markers.setTo(0, (mask == 0) & (far != 0));
  cv::watershed(relief, markers);
  // Pixels on a line between two pieces (-1) go to a neighbour, so that areas add up.
  for (int v = 1; v + 1 < labels.rows; ++v)
    for (int u = 1; u + 1 < labels.cols; ++u) {
      int& label = markers.at<int>(v, u);
      if (label != -1 || mask.at<std::uint8_t>(v, u) == 0) continue;
      for (const auto& [dv, du] : {std::pair{0, -1}, {-1, 0}, {0, 1}, {1, 0}}) {
        const int other = markers.at<int>(v + dv, u + du);
        if (other <= 0 || other == outside) continue;
        label = other;
        break;
      }
    }
  markers.setTo(0, (mask == 0) | (markers < 0) | (markers == outside));
  labels = markers;
  giveStripsBack(mask, labels);
}

/// Median; the order of the values changes. NaN if there is none.
template <typename T>
double medianOf(std::vector<T>& values) {
  if (values.empty()) return std::numeric_limits<double>::quiet_NaN();
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return static_cast<double>(*middle);
}

/// Heights of a surface as a plane: h = c . (u - u_0, v - v_0, 1).
struct HeightPlane {
  cv::Point origin;
  Eigen::Vector3d c{0.0, 0.0, 0.0};
  double at(double u, double v) const {
    return c.dot(Eigen::Vector3d(u - origin.x, v - origin.y, 1.0));
  }
};

/// Least squares through the heights of some pixels, outliers left out.
HeightPlane planeOf(const std::vector<cv::Point>& pixels, const cv::Mat& height) {
  HeightPlane plane;
  if (pixels.empty()) return plane;
  plane.origin = pixels[pixels.size() / 2];
  std::vector<float> values;
  for (const cv::Point& p : pixels) values.push_back(height.at<float>(p));
  plane.c.z() = medianOf(values);
  for (int round = 0; round < 3; ++round) {
    Eigen::Matrix3d H = Eigen::Matrix3d::Zero();
    Eigen::Vector3d g = Eigen::Vector3d::Zero();
    for (const cv::Point& p : pixels) {
      const double h = height.at<float>(p);
      if (!(std::abs(h - plane.at(p.x, p.y)) < (round == 0 ? 2.0 : 1.0) * kOutlier)) continue;
      const Eigen::Vector3d x(p.x - plane.origin.x, p.y - plane.origin.y, 1.0);
      H += x * x.transpose();
      g += h * x;
    }
    if (H(2, 2) < 20.0) break;
    // Few pixels say little about a tilt.
    H(0, 0) += kTiltPrior;
    H(1, 1) += kTiltPrior;
    plane.c = H.ldlt().solve(g);
  }
  return plane;
}

double solidity(const std::vector<cv::Point>& points) {
  std::vector<cv::Point> hull;
  cv::convexHull(points, hull);
  // A contour through centres of pixels misses half a pixel all around.
  const double area = cv::contourArea(hull) + 0.5 * cv::arcLength(hull, true) + 1.0;
  return static_cast<double>(points.size()) / area;
}

/// Two pieces that touch.
struct Seam {
  std::vector<cv::Point> points;  // pixels of the first beside the second
};

class Joiner {
 public:
  Joiner(const cv::Mat& brightness, const cv::Mat& redness, const cv::Mat& height,
         const PieceLimits& limits, cv::Mat& labels, int pieces)
      : brightness_(brightness),
        redness_(redness),
        height_(height),
        limits_(limits),
        labels_(labels) {
    pixels_.resize(static_cast<std::size_t>(pieces) + 1);
    for (int v = 0; v < labels.rows; ++v)
      for (int u = 0; u < labels.cols; ++u) {
        const int label = labels.at<int>(v, u);
        if (label > 0) pixels_[static_cast<std::size_t>(label)].emplace_back(u, v);
      }
    for (const std::vector<cv::Point>& list : pixels_) planes_.push_back(planeOf(list, height));
    colours_ = medians(labels, redness, pieces);
  }

  /// Joins the most obvious pair until none is.
  void run() {
    for (;;) {
      const std::map<std::pair<int, int>, Seam> seams = findSeams();
      double best = 0.0;
      std::pair<int, int> pair;
      for (const auto& [key, seam] : seams) {
        const double score = togetherness(key.first, key.second, seam);
        if (score <= best) continue;
        best = score;
        pair = key;
      }
      if (best <= 0.0) return;
      join(pair.first, pair.second);
    }
  }

 private:
  std::map<std::pair<int, int>, Seam> findSeams() const {
    std::map<std::pair<int, int>, Seam> seams;
    for (int v = 0; v + 1 < labels_.rows; ++v)
      for (int u = 0; u + 1 < labels_.cols; ++u) {
        const int here = labels_.at<int>(v, u);
        if (here == 0) continue;
        for (const auto& [dv, du] : {std::pair{0, 1}, {1, 0}}) {
          const int there = labels_.at<int>(v + dv, u + du);
          if (there != 0 && there != here)
            seams[std::minmax(here, there)].points.emplace_back(u, v);
        }
      }
    return seams;
  }

  /// > 0: one fragment. Each doubt weighs against it.
  double togetherness(int a, int b, const Seam& seam) const {
    std::vector<cv::Point> both = pixels_[static_cast<std::size_t>(a)];
    const std::vector<cv::Point>& other = pixels_[static_cast<std::size_t>(b)];
    both.insert(both.end(), other.begin(), other.end());
    const cv::RotatedRect box = cv::minAreaRect(both);
    const double size =
        std::max(box.size.width, box.size.height) / (limits_.length_max * limits_.pixels_per_metre);
    if (size > 1.0) return -1.0;
    // What is small together is more likely one.
    const double trust = 1.0 + 2.0 * std::clamp((kUsualSize - size) / kSizeSpread, -0.5, 1.0);
    const double solid = solidity(both);
    if (solid < kConcave) return -1.0;
    const double step = seamStep(a, b, seam) / kHeightStep;
    const double dark = seamDarkness(a, b, seam) / kSeamDark;
    const std::vector<cv::Point>& first = pixels_[static_cast<std::size_t>(a)];
    const double share = static_cast<double>(first.size()) / static_cast<double>(both.size());
    const double parts = share * solidity(first) + (1.0 - share) * solidity(other);
    const double hollow = (parts - solid) / kHollow;
    const double colour =
        std::abs(colours_[static_cast<std::size_t>(a)] - colours_[static_cast<std::size_t>(b)]) /
        kColourStep;
    const auto doubt = [](double x) { return x > 0.0 ? x * x : 0.0; };
    return trust - doubt(step) - doubt(dark) - doubt(hollow) - doubt(colour);
  }

  /// How much one surface is above the other where they meet: the median along the seam [m].
  double seamStep(int a, int b, const Seam& seam) const {
    std::vector<double> steps;
    for (const cv::Point& p : seam.points)
      steps.push_back(planes_[static_cast<std::size_t>(a)].at(p.x, p.y) -
                      planes_[static_cast<std::size_t>(b)].at(p.x, p.y));
    return std::abs(medianOf(steps));
  }

  /// How much darker than both sides, in logarithm: the median along the seam of the lesser drop.
  double seamDarkness(int a, int b, const Seam& seam) const {
    constexpr int kReach = 5;  // [px] to either side
    std::vector<double> drops;
    for (const cv::Point& p : seam.points) {
      double side[2] = {0.0, 0.0};
      int count[2] = {0, 0};
      double line = 255.0;
      for (int dv = -kReach; dv <= kReach; ++dv)
        for (int du = -kReach; du <= kReach; ++du) {
          const int v = p.y + dv;
          const int u = p.x + du;
          if (u < 0 || v < 0 || u >= labels_.cols || v >= labels_.rows) continue;
          const int label = labels_.at<int>(v, u);
          const int r2 = du * du + dv * dv;
          const double value = brightness_.at<std::uint8_t>(v, u);
          if (r2 <= 2 && label != 0) line = std::min(line, value);
          if (r2 < 9 || r2 > kReach * kReach) continue;
          if (label == a) side[0] += value, ++count[0];
          if (label == b) side[1] += value, ++count[1];
        }
      if (count[0] == 0 || count[1] == 0) continue;
      drops.push_back(std::min(side[0] / count[0], side[1] / count[1]) - line);
    }
    return drops.empty() ? 0.0 : medianOf(drops) / kLevelsPerLog;
  }

  void join(int a, int b) {
    std::vector<cv::Point>& from = pixels_[static_cast<std::size_t>(b)];
    std::vector<cv::Point>& into = pixels_[static_cast<std::size_t>(a)];
    for (const cv::Point& p : from) labels_.at<int>(p) = a;
    into.insert(into.end(), from.begin(), from.end());
    from.clear();
    planes_[static_cast<std::size_t>(a)] = planeOf(into, height_);
    std::vector<float> values;
    for (const cv::Point& p : into) values.push_back(redness_.at<float>(p));
    colours_[static_cast<std::size_t>(a)] = medianOf(values);
  }

  const cv::Mat& brightness_;
  const cv::Mat& redness_;
  const cv::Mat& height_;
  PieceLimits limits_;
  cv::Mat& labels_;
  std::vector<std::vector<cv::Point>> pixels_;  // by label
  std::vector<HeightPlane> planes_;             // by label
  std::vector<double> colours_;                 // by label: redness
};

/// Numbers from 1 without gaps.
void renumber(cv::Mat& labels) {
  std::map<int, int> numbers;
  for (int v = 0; v < labels.rows; ++v)
    for (int u = 0; u < labels.cols; ++u) {
      int& label = labels.at<int>(v, u);
      if (label != 0)
        label = numbers.emplace(label, static_cast<int>(numbers.size()) + 1).first->second;
    }
}

}  // namespace

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

std::vector<std::vector<bool>> findOcclusions(const cv::Mat& labels, const cv::Mat& height,
                                              int pieces) {
  const std::size_t n = static_cast<std::size_t>(pieces) + 1;
  std::map<std::pair<int, int>, std::vector<float>> near;  // heights of the first near the second
  for (int v = 0; v < labels.rows; ++v)
    for (int u = 0; u < labels.cols; ++u) {
      const int here = labels.at<int>(v, u);
      if (here == 0) continue;
      int last = here;
      for (const auto& [dv, du] : {std::pair{0, 1}, {1, 0}, {0, -1}, {-1, 0}, {1, 1}, {-1, -1}}) {
        const int y = v + kSeamReach * dv;
        const int x = u + kSeamReach * du;
        if (x < 0 || y < 0 || x >= labels.cols || y >= labels.rows) continue;
        const int there = labels.at<int>(y, x);
        if (there == 0 || there == here || there == last) continue;
        near[{here, there}].push_back(height.at<float>(v, u));
        last = there;
      }
    }
  std::vector<std::vector<bool>> hides(n, std::vector<bool>(n, false));
  for (auto& [pair, heights] : near) {
    const auto other = near.find({pair.second, pair.first});
    if (other == near.end()) continue;
    hides[static_cast<std::size_t>(pair.first)][static_cast<std::size_t>(pair.second)] =
        medianOf(other->second) > medianOf(heights) + kInFront;
  }
  return hides;
}

cv::Mat splitFoam(const cv::Mat& image, const cv::Mat& redness, const cv::Mat& mask,
                  const cv::Mat& height, const PieceLimits& limits) {
  const cv::Mat brightness = logBrightness(image);
  cv::Mat edges;
  cv::Canny(brightness, edges, kEdgeLow, kEdgeHigh, 3, true);
  edges |= edgesOf(redness, mask, 100.0, 0.0, kColourLow, kColourHigh);
  edges |= edgesOf(height, mask, 1e4, 0.001, kStepLow, kStepHigh);
  cv::Mat inner;
  cv::erode(mask, inner, cv::getStructuringElement(cv::MORPH_ELLIPSE, {5, 5}));
  cv::Mat cut = mask.clone();
  cut.setTo(0, (edges != 0) & (inner != 0));
  cv::Mat distance;
  cv::distanceTransform(cut, distance, cv::DIST_L2, cv::DIST_MASK_5);
  cv::GaussianBlur(distance, distance, cv::Size(), 1.0);
  distance.setTo(0.0, mask == 0);
  int pieces = 0;
  cv::Mat labels =
      findPeaks(distance, static_cast<float>(limits.radius_min * limits.pixels_per_metre), pieces);
  flood(brightness, mask, labels);
  Joiner(brightness, redness, height, limits, labels, pieces).run();
  renumber(labels);
  return labels;
}

cv::Mat transferPieces(const cv::Mat& left_labels, const cv::Mat& height, const cv::Mat& right,
                       const cv::Mat& right_mask, const PlaneSweep& sweep) {
  double last = 0.0;
  cv::minMaxLoc(left_labels, nullptr, &last);
  const int pieces = static_cast<int>(last);
  const std::vector<double> heights = medians(left_labels, height, pieces);
  // The lowest first: where pieces fall on one another, the upper one is seen.
  std::vector<int> order(static_cast<std::size_t>(pieces));
  std::iota(order.begin(), order.end(), 1);
  std::sort(order.begin(), order.end(), [&](int a, int b) {
    return heights[static_cast<std::size_t>(a)] < heights[static_cast<std::size_t>(b)];
  });
  cv::Mat moved = cv::Mat::zeros(right.size(), CV_32SC1);
  for (const int k : order) {
    const cv::Mat whole = left_labels == k;
    const cv::Rect box = cv::boundingRect(whole);
    const cv::Mat piece = whole(box);
    std::vector<cv::Point> pixels;
    for (int v = 0; v < box.height; ++v)
      for (int u = 0; u < box.width; ++u)
        if (piece.at<std::uint8_t>(v, u) != 0) pixels.emplace_back(box.x + u, box.y + v);
    const HeightPlane plane = planeOf(pixels, height);
    for (int v = 0; v < box.height; ++v) {
      int before = -1;  // column of the pixel to the left: gaps between both are closed
      for (int u = 0; u < box.width; ++u) {
        if (piece.at<std::uint8_t>(v, u) == 0) {
          before = -1;
          continue;
        }
        const double there =
            sweep.rightColumn(box.x + u, box.y + v, plane.at(box.x + u, box.y + v));
        const int column = static_cast<int>(std::lround(there));
        if (column < 0 || column >= right.cols) continue;
        const int from = before >= 0 && column - before == 2 ? column - 1 : column;
        for (int c = from; c <= column; ++c) moved.at<int>(box.y + v, c) = k;
        before = column;
      }
    }
  }
  moved.setTo(0, right_mask == 0);
  // Near the edge of a piece the right image decides, from the pixels that are sure.
  cv::Mat labels = cv::Mat::zeros(right.size(), CV_32SC1);
  for (int k = 1; k <= pieces; ++k) {
    const cv::Mat whole = moved == k;
    cv::Rect box = cv::boundingRect(whole);
    if (box.empty()) continue;
    cv::Mat framed;
    cv::Mat distance;
    cv::copyMakeBorder(whole(box), framed, 1, 1, 1, 1, cv::BORDER_CONSTANT, cv::Scalar(0));
    cv::distanceTransform(framed, distance, cv::DIST_L2, cv::DIST_MASK_5);
    double largest = 0.0;
    cv::minMaxLoc(distance, nullptr, &largest);
    const double sure = std::min<double>(kUnsure, 0.7 * largest);
    labels(box).setTo(k, distance(cv::Rect(1, 1, box.width, box.height)) >= sure);
  }
  flood(logBrightness(right), right_mask, labels);
  return labels;
}

}  // namespace raven_correction
