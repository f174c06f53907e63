// SPDX-License-Identifier: BSD-3-Clause
// Which regions of foam that touch are one fragment: what speaks for and against it, and how much
// each of these cues is worth. The regions come from piece_flood.h.
#pragma once

#include <array>
#include <functional>
#include <map>
#include <opencv2/core.hpp>
#include <vector>

#include "foam_colour.h"
#include "piece_surface.h"

namespace raven_correction {

struct PieceLimits {
  double pixels_per_metre = 4000.0;
  double length_max = 0.016;  ///< [m]
};

/// What can be seen of two touching pieces a and b.
struct PieceCues {
  double colour = 0.0;       ///< distance of their colours, per its deviation in one fragment [-]
  double near_colour = 0.0;  ///< likewise of the pixels near the seam only
  double hue = 0.0;          ///< difference of log(B / G) alone, which saturated red does not spoil
  double step = 0.0;         ///< of their surfaces where they meet [mm]
  double near_step = 0.0;    ///< of the heights near the seam [mm]
  double valley = 0.0;       ///< how much lower the seam is than both sides [mm]
  double bend = 0.0;         ///< > 0: their surfaces meet like a valley, < 0 like a roof [mm]
  double dark = 0.0;         ///< how much darker the seam is than both sides, logarithm [-]
  double contrast = 0.0;     ///< difference of brightness, logarithm [-]
  double hollow = 0.0;       ///< how much more convex the parts are than both together [-]
  double solidity = 0.0;     ///< area of both per area of their hull [-]
  double roundness = 0.0;    ///< share of both inside the superellipse of the same moments [-]
  double length = 0.0;       ///< of both per length_max [-]
  double width = 0.0;        ///< of both per length_max [-]
  double small = 0.0;        ///< area of the smaller one per length_max^2 [-]
  double narrow = 0.0;       ///< width of the smaller one per length_max [-]
  double seam = 0.0;         ///< length of the seam per root of the smaller area [-]
  double grain = 0.0;        ///< difference of how coarse their pores look, logarithm [-]

  static constexpr std::size_t kCount = 18;
  std::array<double, kCount> values() const;
};

/// Joins pieces pair by pair, the most certain pair first, while one is more likely one fragment
/// than two.
class PieceJoiner {
 public:
  /// Logarithm of the odds that both are parts of one fragment.
  using Judge = std::function<double(int a, int b, const PieceCues& cues)>;

  PieceJoiner(const FoamColour& colour, const cv::Mat& height, const PieceLimits& limits,
              cv::Mat& labels, int pieces);
  /// @param judge  logOdds() unless somebody knows better (training does)
  void run(const Judge& judge);
  static double logOdds(const PieceCues& cues);

 private:
  struct Piece {
    std::vector<cv::Point> pixels;
    PieceSurface surface;
    double sum[3] = {};     // of linear light, blue green red
    double square[3] = {};  // of its squares
    double known = 0.0;     // pixels of these
    double brightness = 0.0;
    double grain = 0.0;
    double solidity = 0.0;
    double narrow = 0.0;
  };
  using Pair = std::pair<int, int>;
  using Seams = std::map<Pair, std::vector<cv::Point>>;

  void describe(Piece& piece) const;
  Seams findSeams() const;
  PieceCues cuesOf(int a, int b, const std::vector<cv::Point>& seam) const;
  void join(int a, int b, Seams& seams);

  const FoamColour& colour_;
  cv::Mat detail_;  // brightness less its mean around
  const cv::Mat& height_;
  PieceLimits limits_;
  cv::Mat& labels_;
  std::vector<Piece> pieces_;  // by label
};

}  // namespace raven_correction
