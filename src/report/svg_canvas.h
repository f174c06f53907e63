// SPDX-License-Identifier: BSD-3-Clause
// Elements of SVG, one after the other, with short numbers and escaped text. What is drawn with
// them is panel_svg.cpp and layer_svg.cpp.
#pragma once

#include <string>
#include <vector>

#include "raven_correction/report/figure.h"

namespace raven_correction {

/// A tenth of a pixel is as exact as anybody sees: "12.5", "3", "-0.4".
std::string pixels(double value);

struct Pixel {
  double x = 0.0, y = 0.0;
};
/// False for what a logarithmic axis makes of zero, e.g.
bool isFinite(const Pixel& pixel);

/// How a line or an area looks.
struct Paint {
  std::string stroke = "none", fill = "none";
  double width = 1.0;
  Stroke pattern = Stroke::kSolid;
  double opacity = 1.0;  ///< of both
};

/// Elements with a corner that is not finite are left out.
class SvgCanvas {
 public:
  void line(const Pixel& from, const Pixel& to, const Paint& paint);
  void rectangle(const Pixel& corner, double width, double height, const Paint& paint);
  /// @param data  as in the attribute `d`
  void path(const std::string& data, const Paint& paint);
  /// Dots of one size as one path. @param marker  circle and square cost a dozen bytes each
  void dots(const std::vector<Pixel>& at, Marker marker, double size, const std::string& colour,
            double opacity);
  /// @param anchor   "start", "middle" or "end"
  /// @param degrees  turned about its anchor
  void text(const Pixel& at, const std::string& words, const char* anchor, double size,
            const char* colour = "#222222", double degrees = 0.0, bool bold = false);
  void raw(const std::string& element) { out_ += element; }
  std::string take() { return std::move(out_); }

 private:
  std::string out_;
};

/// "M1 2L3 4", interrupted where a point is not finite.
std::string polyline(const std::vector<Pixel>& points);

/// Rough width of a text in a sans-serif font [px].
double textWidth(const std::string& words, double size);

}  // namespace raven_correction
