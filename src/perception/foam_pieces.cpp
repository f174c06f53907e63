// SPDX-License-Identifier: BSD-3-Clause
#include "foam_pieces.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <opencv2/imgproc.hpp>

#include "piece_flood.h"

namespace raven_correction {
namespace {

constexpr int kCell = 11;          // one core of a piece per square cell of this side [px]
constexpr double kCoreBlur = 1.0;  // of the relief before the lowest point of a cell is taken [px]
constexpr int kRim = 5;            // twice the width of an outline, which is an edge, too [px]
// What a step of one unit is worth in the watershed.
constexpr double kBrightnessWorth = 1.0;
constexpr double kColourWorth = 2.0;
constexpr double kHeightWorth = 150.0;
constexpr double kReliefScale = 600.0;  // levels per unit of worth and px
constexpr double kInFront = 0.0004;     // higher than the other along their seam [m]
constexpr int kSeamReach = 4;           // from the seam, where heights are compared [px]
constexpr float kUnsure = 2.5f;  // from the edge of a piece, where the right image decides [px]
constexpr double kColourDiffers = 0.12;  // length of a difference of (log G/R, log B/R)
constexpr double kStay = 0.05;           // of that difference: a pixel keeps its label if unsure
constexpr int kBand = 6;                 // about a border that is moved [px]

int lastOf(const cv::Mat& labels) {
  double last = 0.0;
  cv::minMaxLoc(labels, nullptr, &last);
  return static_cast<int>(last);
}

/// Without gaps and speckles.
cv::Mat smoothHeight(const cv::Mat& height) {
  cv::Mat smooth = height.clone();
  cv::patchNaNs(smooth, 0.0);
  cv::medianBlur(smooth, smooth, 5);
  cv::GaussianBlur(smooth, smooth, cv::Size(), 1.0);
  return smooth;
}

/// How steeply everything changes at a pixel.
/// @param height  may be empty
/// @return 8UC1
cv::Mat reliefOf(const FoamColour& colour, const cv::Mat& height) {
  cv::Mat sum = cv::Mat::zeros(colour.brightness.size(), CV_32FC1);
  const auto add = [&sum](const cv::Mat& values, double worth) {
    cv::Mat dx;
    cv::Mat dy;
    cv::Sobel(values, dx, CV_32F, 1, 0, 3, worth / 8.0);
    cv::Sobel(values, dy, CV_32F, 0, 1, 3, worth / 8.0);
    sum += dx.mul(dx) + dy.mul(dy);
  };
  add(colour.brightness, kBrightnessWorth);
  add(colour.green, kColourWorth);
  add(colour.blue, kColourWorth);
  if (!height.empty()) add(smoothHeight(height), kHeightWorth);
  cv::Mat relief;
  cv::sqrt(sum, relief);
  relief.convertTo(relief, CV_8U, kReliefScale);
  return relief;
}

/// (log G/R, log B/R) of each piece, by label; (0, 0) where it is not known.
std::vector<cv::Vec2d> coloursOf(const cv::Mat& labels, const FoamColour& colour, int pieces) {
  std::vector<cv::Vec3d> sums(static_cast<std::size_t>(pieces) + 1);
  for (int v = 0; v < labels.rows; ++v)
    for (int u = 0; u < labels.cols; ++u) {
      const int label = labels.at<int>(v, u);
      if (label > 0) sums[static_cast<std::size_t>(label)] += colour.light.at<cv::Vec3f>(v, u);
    }
  std::vector<cv::Vec2d> result;
  for (const cv::Vec3d& s : sums)
    result.push_back(s[0] > 0.0 && s[1] > 0.0 && s[2] > 0.0
                         ? cv::Vec2d(std::log(s[1] / s[2]), std::log(s[0] / s[2]))
                         : cv::Vec2d(0.0, 0.0));
  return result;
}

/// Keeps the largest connected part of each piece and gives the others to their neighbours.
void keepWhole(const cv::Mat& mask, cv::Mat& labels) {
  const int pieces = lastOf(labels);
  cv::Mat kept = cv::Mat::zeros(labels.size(), CV_32SC1);
  for (int k = 1; k <= pieces; ++k) {
    const cv::Mat whole = labels == k;
    const cv::Rect box = cv::boundingRect(whole);
    if (box.empty()) continue;
    cv::Mat parts;
    cv::Mat statistics;
    cv::Mat unused;
    const int n = cv::connectedComponentsWithStats(whole(box), parts, statistics, unused, 4);
    int largest = 1;
    for (int i = 2; i < n; ++i)
      if (statistics.at<int>(i, cv::CC_STAT_AREA) > statistics.at<int>(largest, cv::CC_STAT_AREA))
        largest = i;
    kept(box).setTo(k, parts == largest);
  }
  flood(cv::Mat::zeros(mask.size(), CV_8UC1), mask, kept);
  labels = kept;
}

/// A region of foam that is too narrow for a core of a cell has one in its middle.
void addMissingCores(const cv::Mat& mask, cv::Mat& labels, int& cores) {
  cv::Mat regions;
  const int n = cv::connectedComponents(mask, regions, 4, CV_32S);
  std::vector<bool> has_core(static_cast<std::size_t>(n), false);
  for (int v = 0; v < labels.rows; ++v)
    for (int u = 0; u < labels.cols; ++u)
      if (labels.at<int>(v, u) > 0)
        has_core[static_cast<std::size_t>(regions.at<int>(v, u))] = true;
  cv::Mat distance;
  cv::distanceTransform(mask, distance, cv::DIST_L2, cv::DIST_MASK_5);
  for (int k = 1; k < n; ++k) {
    if (has_core[static_cast<std::size_t>(k)]) continue;
    cv::Point middle;
    cv::minMaxLoc(distance, nullptr, nullptr, nullptr, &middle, regions == k);
    labels.at<int>(middle) = ++cores;
  }
}

/// Near a border between pieces of different colours each pixel goes to the one whose colour it
/// has.
void moveBorders(const FoamColour& colour, const std::vector<cv::Vec2d>& colours,
                 const cv::Mat& mask, cv::Mat& labels) {
  const cv::Mat before = labels.clone();
  for (int v = kBand; v + kBand < labels.rows; ++v)
    for (int u = kBand; u + kBand < labels.cols; ++u) {
      const int here = before.at<int>(v, u);
      if (here == 0) continue;
      const cv::Vec2d own = colours[static_cast<std::size_t>(here)];
      const cv::Vec2d seen(colour.green.at<float>(v, u), colour.blue.at<float>(v, u));
      int best = here;
      double least = cv::norm(seen - own) - kStay;
      for (const int reach : {2, 4, kBand})
        for (const auto& [dv, du] :
             {std::pair{0, 1}, {1, 0}, {0, -1}, {-1, 0}, {1, 1}, {-1, -1}, {1, -1}, {-1, 1}}) {
          const int there = before.at<int>(v + reach * dv, u + reach * du);
          if (there == 0 || there == here) continue;
          const cv::Vec2d other = colours[static_cast<std::size_t>(there)];
          if (other == cv::Vec2d() || own == cv::Vec2d() || cv::norm(other - own) < kColourDiffers)
            continue;
          const double distance = cv::norm(seen - other);
          if (distance >= least) continue;
          least = distance;
          best = there;
        }
      labels.at<int>(v, u) = best;
    }
  keepWhole(mask, labels);
}

}  // namespace

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

cv::Mat cutIntoPieces(const FoamColour& colour, const cv::Mat& mask, const cv::Mat& height,
                      int& pieces) {
  const cv::Mat relief = reliefOf(colour, height);
  cv::Mat smooth;
  cv::GaussianBlur(relief, smooth, cv::Size(), kCoreBlur);
  cv::Mat inner;
  cv::erode(mask, inner, cv::getStructuringElement(cv::MORPH_ELLIPSE, {kRim, kRim}));
  smooth.setTo(255, inner == 0);
  cv::Mat labels = cv::Mat::zeros(mask.size(), CV_32SC1);
  pieces = 0;
  for (int v = 0; v < mask.rows; v += kCell)
    for (int u = 0; u < mask.cols; u += kCell) {
      const cv::Rect cell = cv::Rect(u, v, kCell, kCell) & cv::Rect(0, 0, mask.cols, mask.rows);
      if (cv::countNonZero(inner(cell)) == 0) continue;
      cv::Point lowest;
      cv::minMaxLoc(smooth(cell), nullptr, nullptr, &lowest, nullptr, inner(cell));
      labels.at<int>(lowest + cell.tl()) = ++pieces;
    }
  addMissingCores(mask, labels, pieces);
  flood(relief, mask, labels);
  return labels;
}

cv::Mat splitFoam(const FoamColour& colour, const cv::Mat& mask, const cv::Mat& height,
                  const PieceLimits& limits) {
  int pieces = 0;
  cv::Mat labels = cutIntoPieces(colour, mask, height, pieces);
  PieceJoiner(colour, height, limits, labels, pieces).run([](int, int, const PieceCues& cues) {
    return PieceJoiner::logOdds(cues);
  });
  pieces = renumber(labels);
  moveBorders(colour, coloursOf(labels, colour, pieces), mask, labels);
  return labels;
}

cv::Mat transferPieces(const cv::Mat& left_labels, const FoamColour& left_colour,
                       const cv::Mat& height, const FoamColour& right_colour,
                       const cv::Mat& right_mask, const PlaneSweep& sweep) {
  const int pieces = lastOf(left_labels);
  const std::vector<double> heights = medians(left_labels, height, pieces);
  // The lowest first: where pieces fall on one another, the upper one is seen.
  std::vector<int> order(static_cast<std::size_t>(pieces));
  std::iota(order.begin(), order.end(), 1);
  std::sort(order.begin(), order.end(), [&](int a, int b) {
    return heights[static_cast<std::size_t>(a)] < heights[static_cast<std::size_t>(b)];
  });
  cv::Mat moved = cv::Mat::zeros(right_mask.size(), CV_32SC1);
  for (const int k : order) {
    const cv::Mat whole = left_labels == k;
    const cv::Rect box = cv::boundingRect(whole);
    const cv::Mat piece = whole(box);
    std::vector<cv::Point> pixels;
    for (int v = 0; v < box.height; ++v)
      for (int u = 0; u < box.width; ++u)
        if (piece.at<std::uint8_t>(v, u) != 0) pixels.emplace_back(box.x + u, box.y + v);
    const PieceSurface plane = fitSurface(pixels, height);
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
        if (column < 0 || column >= right_mask.cols) continue;
        const int from = before >= 0 && column - before == 2 ? column - 1 : column;
        for (int c = from; c <= column; ++c) moved.at<int>(box.y + v, c) = k;
        before = column;
      }
    }
  }
  moved.setTo(0, right_mask == 0);
  // Near the edge of a piece the right image decides, from the pixels that are sure.
  cv::Mat labels = cv::Mat::zeros(right_mask.size(), CV_32SC1);
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
  flood(reliefOf(right_colour, cv::Mat()), right_mask, labels);
  giveStripsBack(right_mask, labels);
  moveBorders(right_colour, coloursOf(left_labels, left_colour, pieces), right_mask, labels);
  return labels;
}

}  // namespace raven_correction
