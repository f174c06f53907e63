// SPDX-License-Identifier: BSD-3-Clause
#include "piece_joiner.h"

#include <Eigen/Core>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

namespace raven_correction {
namespace {

constexpr double kLightColour = 0.05;  // by which light changes log(G / R) within one fragment
constexpr double kColourLimit = 6.0;   // deviations; more says no more
constexpr double kFewestKnown = 12.0;  // pixels that tell a colour
constexpr double kDetailBlur = 3.0;    // [px]
constexpr int kNearFrom = 2;           // from the seam: what is near it [px]
constexpr int kNearTo = 7;             // [px]
constexpr double kStepLimit = 4.0;     // [mm]
constexpr double kMillimetres = 1e3;   // per metre
constexpr double kSuperellipse = 3.0;  // exponent
// Of the superellipse |x/a|^3 + |y/b|^3 = 1: variance along x per a^2.
constexpr double kSuperellipseVariance = 0.283;

// Logistic regression of "both are parts of one fragment" on the cues, in the order of
// PieceCues::values(). Trained on pairs of pieces of rendered scenes that no test looks at
// (doc/perception.md); less kCaution, because a wrong join is final and a wrong cut is not.
constexpr double kCaution = 0.7;
constexpr double kBias = -11.262 - kCaution;
constexpr std::array<double, PieceCues::kCount> kWeights = {
    -0.505,   // colour
    -0.630,   // near_colour
    -1.599,   // hue
    -1.044,   // step
    -0.346,   // near_step
    -0.569,   // valley
    -1.065,   // bend
    -5.389,   // dark
    -0.721,   // contrast
    5.651,    // hollow
    -1.446,   // solidity
    22.949,   // roundness
    -4.614,   // length
    -0.100,   // width
    -16.520,  // small
    -3.350,   // narrow
    1.907,    // seam
    0.382,    // grain
};

double solidityOf(const std::vector<cv::Point>& points) {
  std::vector<cv::Point> hull;
  cv::convexHull(points, hull);
  // A contour through centres of pixels misses half a pixel all around.
  const double area = cv::contourArea(hull) + 0.5 * cv::arcLength(hull, true) + 1.0;
  return static_cast<double>(points.size()) / area;
}

/// Share of the pixels inside the superellipse with the same second moments.
double roundnessOf(const std::vector<cv::Point>& a, const std::vector<cv::Point>& b) {
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  Eigen::Matrix2d square = Eigen::Matrix2d::Zero();
  const auto forEach = [&](const auto& visit) {
    for (const auto* list : {&a, &b})
      for (const cv::Point& p : *list) visit(Eigen::Vector2d(p.x, p.y));
  };
  forEach([&](const Eigen::Vector2d& p) {
    sum += p;
    square += p * p.transpose();
  });
  const auto n = static_cast<double>(a.size() + b.size());
  const Eigen::Vector2d mean = sum / n;
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> axes(square / n - mean * mean.transpose());
  const Eigen::Vector2d half =
      (axes.eigenvalues().cwiseMax(0.1) / kSuperellipseVariance).cwiseSqrt();
  double inside = 0.0;
  forEach([&](const Eigen::Vector2d& p) {
    const Eigen::Vector2d q =
        (axes.eigenvectors().transpose() * (p - mean)).cwiseQuotient(half).cwiseAbs();
    inside += std::pow(q.x(), kSuperellipse) + std::pow(q.y(), kSuperellipse) <= 1.0;
  });
  return inside / n;
}

/// Sums of linear light: what colour some pixels have, and how well that is known.
struct ColourSums {
  double sum[3] = {};
  double square[3] = {};
  double n = 0.0;
  void add(const cv::Vec3f& light) {
    if (light[2] <= 0.0f) return;
    for (int c = 0; c < 3; ++c) {
      const double x = light[c];
      sum[c] += x;
      square[c] += x * x;
    }
    n += 1.0;
  }
};

/// Logarithm of the mean, and its variance.
struct LogMean {
  double value = 0.0;
  double variance = 1.0;
};
LogMean logMean(const double sum, const double square, double n) {
  const double mean = std::max(sum / n, 1e-4);
  const double variance = std::max(0.0, square / n - mean * mean);
  // Neighbouring pixels share some noise, and shading is no noise: only roughly.
  return {std::log(mean), 2.0 * variance / (mean * mean * n)};
}

/// Distance of two colours in deviations; 0 where one is not known.
template <typename A, typename B>
double colourDistance(const A& a, double n_a, const B& b, double n_b, double* hue) {
  *hue = 0.0;
  if (n_a < kFewestKnown || n_b < kFewestKnown) return 0.0;
  LogMean of_a[3];
  LogMean of_b[3];
  for (int c = 0; c < 3; ++c) {
    of_a[c] = logMean(a.sum[c], a.square[c], n_a);
    of_b[c] = logMean(b.sum[c], b.square[c], n_b);
  }
  const auto difference = [&](int c, int d) {
    return (of_a[c].value - of_a[d].value) - (of_b[c].value - of_b[d].value);
  };
  const auto variance = [&](int c) { return of_a[c].variance + of_b[c].variance; };
  const double floor = kLightColour * kLightColour;
  *hue = std::min(kColourLimit, std::abs(difference(0, 1)) /
                                    std::sqrt(floor + 0.3 * (variance(0) + variance(1))));
  // Shading is common to the channels; what is left of it in the ratios is what counts.
  const double d2 = std::pow(difference(1, 2), 2.0) / (floor + 0.3 * variance(1)) +
                    std::pow(difference(0, 2), 2.0) / (floor + 0.3 * variance(0));
  return std::min(kColourLimit, std::sqrt(d2));
}

double clamp(double x, double limit) { return std::clamp(x, -limit, limit); }

}  // namespace

std::array<double, PieceCues::kCount> PieceCues::values() const {
  return {colour, near_colour, hue,       step,   near_step, valley, bend,   dark, contrast,
          hollow, solidity,    roundness, length, width,     small,  narrow, seam, grain};
}

PieceJoiner::PieceJoiner(const FoamColour& colour, const cv::Mat& height, const PieceLimits& limits,
                         cv::Mat& labels, int pieces)
    : colour_(colour), height_(height), limits_(limits), labels_(labels) {
  cv::GaussianBlur(colour.brightness, detail_, cv::Size(), kDetailBlur);
  detail_ = colour.brightness - detail_;
  pieces_.resize(static_cast<std::size_t>(pieces) + 1);
  for (int v = 0; v < labels.rows; ++v)
    for (int u = 0; u < labels.cols; ++u) {
      const int label = labels.at<int>(v, u);
      if (label > 0) pieces_[static_cast<std::size_t>(label)].pixels.emplace_back(u, v);
    }
  for (Piece& piece : pieces_) describe(piece);
}

void PieceJoiner::describe(Piece& piece) const {
  if (piece.pixels.empty()) return;
  piece.surface = fitSurface(piece.pixels, height_);
  ColourSums sums;
  std::vector<float> brightness;
  double detail = 0.0;
  for (const cv::Point& p : piece.pixels) {
    sums.add(colour_.light.at<cv::Vec3f>(p));
    brightness.push_back(colour_.brightness.at<float>(p));
    detail += std::abs(detail_.at<float>(p));
  }
  std::copy(sums.sum, sums.sum + 3, piece.sum);
  std::copy(sums.square, sums.square + 3, piece.square);
  piece.known = sums.n;
  piece.brightness = medianOf(brightness);
  piece.grain = std::log(detail / static_cast<double>(piece.pixels.size()) + 1e-3);
  piece.solidity = solidityOf(piece.pixels);
  const cv::RotatedRect box = cv::minAreaRect(piece.pixels);
  piece.narrow =
      std::min(box.size.width, box.size.height) / (limits_.length_max * limits_.pixels_per_metre);
}

PieceJoiner::Seams PieceJoiner::findSeams() const {
  Seams seams;
  for (int v = 0; v + 1 < labels_.rows; ++v)
    for (int u = 0; u + 1 < labels_.cols; ++u) {
      const int here = labels_.at<int>(v, u);
      if (here == 0) continue;
      for (const auto& [dv, du] : {std::pair{0, 1}, {1, 0}}) {
        const int there = labels_.at<int>(v + dv, u + du);
        if (there != 0 && there != here) seams[std::minmax(here, there)].emplace_back(u, v);
      }
    }
  return seams;
}

PieceCues PieceJoiner::cuesOf(int a, int b, const std::vector<cv::Point>& seam) const {
  const Piece& first = pieces_[static_cast<std::size_t>(a)];
  const Piece& second = pieces_[static_cast<std::size_t>(b)];
  const double length_max = limits_.length_max * limits_.pixels_per_metre;
  PieceCues cues;
  cues.colour = colourDistance(first, first.known, second, second.known, &cues.hue);

  // What is near the seam, on either side of it, and on it.
  ColourSums near[2];
  std::vector<float> steps;
  std::vector<float> near_steps;
  std::vector<float> valleys;
  std::vector<float> drops;
  for (const cv::Point& p : seam) {
    steps.push_back(static_cast<float>(first.surface.at(p.x, p.y) - second.surface.at(p.x, p.y)));
    double height[3] = {};
    double brightness[2] = {};
    double count[3] = {};
    double darkest = 1e9;
    for (int dv = -kNearTo; dv <= kNearTo; ++dv)
      for (int du = -kNearTo; du <= kNearTo; ++du) {
        const cv::Point q(p.x + du, p.y + dv);
        if (q.x < 0 || q.y < 0 || q.x >= labels_.cols || q.y >= labels_.rows) continue;
        const int label = labels_.at<int>(q);
        if (label != a && label != b) continue;
        const int r2 = du * du + dv * dv;
        if (r2 > kNearTo * kNearTo) continue;
        if (r2 <= 2) {
          height[2] += height_.at<float>(q);
          count[2] += 1.0;
          darkest = std::min<double>(darkest, colour_.brightness.at<float>(q));
        }
        if (r2 < kNearFrom * kNearFrom) continue;
        const int side = label == a ? 0 : 1;
        near[side].add(colour_.light.at<cv::Vec3f>(q));
        if (r2 < 2 * kNearFrom * kNearFrom) continue;
        height[side] += height_.at<float>(q);
        brightness[side] += colour_.brightness.at<float>(q);
        count[side] += 1.0;
      }
    if (count[0] == 0.0 || count[1] == 0.0 || count[2] == 0.0) continue;
    near_steps.push_back(static_cast<float>(height[0] / count[0] - height[1] / count[1]));
    valleys.push_back(static_cast<float>(std::min(height[0] / count[0], height[1] / count[1]) -
                                         height[2] / count[2]));
    drops.push_back(
        static_cast<float>(std::min(brightness[0] / count[0], brightness[1] / count[1]) - darkest));
  }
  double unused = 0.0;
  // A pixel near the seam has been counted for many points of it.
  const double repeated = std::max(1.0, 0.5 * kNearTo * M_PI);
  for (ColourSums& sums : near) {
    for (int c = 0; c < 3; ++c) {
      sums.sum[c] /= repeated;
      sums.square[c] /= repeated;
    }
    sums.n /= repeated;
  }
  cues.near_colour = colourDistance(near[0], near[0].n, near[1], near[1].n, &unused);
  const auto median = [](std::vector<float>& values) {
    return values.empty() ? 0.0 : medianOf(values);
  };
  cues.step = std::min(kStepLimit, kMillimetres * std::abs(median(steps)));
  cues.near_step = std::min(kStepLimit, kMillimetres * std::abs(median(near_steps)));
  cues.valley = clamp(kMillimetres * median(valleys), kStepLimit);
  cues.dark = clamp(median(drops), 2.0);

  const auto middle = [](const std::vector<cv::Point>& pixels) {
    Eigen::Vector2d sum = Eigen::Vector2d::Zero();
    for (const cv::Point& p : pixels) sum += Eigen::Vector2d(p.x, p.y);
    return Eigen::Vector2d(sum / static_cast<double>(pixels.size()));
  };
  const Eigen::Vector2d across = middle(second.pixels) - middle(first.pixels);
  cues.bend = clamp(
      0.25 * kMillimetres * (second.surface.c.head<2>() - first.surface.c.head<2>()).dot(across),
      kStepLimit);
  cues.contrast = std::min(2.0, std::abs(first.brightness - second.brightness));
  cues.grain = std::min(2.0, std::abs(first.grain - second.grain));

  std::vector<cv::Point> both = first.pixels;
  both.insert(both.end(), second.pixels.begin(), second.pixels.end());
  cues.solidity = solidityOf(both);
  const double share = static_cast<double>(first.pixels.size()) / static_cast<double>(both.size());
  cues.hollow = share * first.solidity + (1.0 - share) * second.solidity - cues.solidity;
  cues.roundness = roundnessOf(first.pixels, second.pixels);
  const cv::RotatedRect box = cv::minAreaRect(both);
  cues.length = std::max(box.size.width, box.size.height) / length_max;
  cues.width = std::min(box.size.width, box.size.height) / length_max;
  const bool first_is_smaller = first.pixels.size() < second.pixels.size();
  const Piece& smaller = first_is_smaller ? first : second;
  const auto area = static_cast<double>(smaller.pixels.size());
  cues.small = area / (length_max * length_max);
  cues.narrow = smaller.narrow;
  cues.seam = static_cast<double>(seam.size()) / std::sqrt(area);
  return cues;
}

void PieceJoiner::run(const Judge& judge) {
  Seams seams = findSeams();
  std::map<Pair, double> scores;
  const auto consider = [&](const Pair& pair) {
    scores[pair] = judge(pair.first, pair.second, cuesOf(pair.first, pair.second, seams.at(pair)));
  };
  for (const auto& [pair, seam] : seams) consider(pair);
  while (!scores.empty()) {
    const auto best =
        std::max_element(scores.begin(), scores.end(),
                         [](const auto& x, const auto& y) { return x.second < y.second; });
    if (!(best->second > 0.0)) return;
    const auto [a, b] = best->first;
    join(a, b, seams);
    for (auto it = scores.begin(); it != scores.end();)
      it = it->first.first == b || it->first.second == b ? scores.erase(it) : std::next(it);
    for (const auto& [pair, seam] : seams)
      if (pair.first == a || pair.second == a) consider(pair);
  }
}

void PieceJoiner::join(int a, int b, Seams& seams) {
  Piece& into = pieces_[static_cast<std::size_t>(a)];
  Piece& from = pieces_[static_cast<std::size_t>(b)];
  for (const cv::Point& p : from.pixels) labels_.at<int>(p) = a;
  into.pixels.insert(into.pixels.end(), from.pixels.begin(), from.pixels.end());
  from.pixels.clear();
  describe(into);
  Seams moved;
  for (auto& [pair, seam] : seams) {
    if (pair == Pair(std::minmax(a, b))) continue;
    const int p = pair.first == b ? a : pair.first;
    const int q = pair.second == b ? a : pair.second;
    std::vector<cv::Point>& list = moved[std::minmax(p, q)];
    list.insert(list.end(), seam.begin(), seam.end());
  }
  seams = std::move(moved);
}

double PieceJoiner::logOdds(const PieceCues& cues) {
  // Longer than a fragment can be.
  if (cues.length > 1.0) return -1.0;
  const std::array<double, PieceCues::kCount> values = cues.values();
  double z = kBias;
  for (std::size_t i = 0; i < values.size(); ++i) z += kWeights[i] * values[i];
  return z;
}

}  // namespace raven_correction
