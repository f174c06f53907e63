// SPDX-License-Identifier: BSD-3-Clause
// The marks of one layer, drawn into the area between the axes. The axes are panel_svg.cpp.
#pragma once

#include <cmath>

#include "raven_correction/report/figure_limits.h"
#include "svg_canvas.h"

namespace raven_correction {

/// From numbers on the axes to pixels inside the plot area, whose origin is its upper left corner.
struct PlotArea {
  double width = 0.0, height = 0.0;  ///< [px]
  Range x, y;
  bool y_down = false;  ///< categories on the y axis are read from the top
  bool x_logarithmic = false, y_logarithmic = false;

  static double share(double value, const Range& range, bool logarithmic) {
    return logarithmic ? std::log(value / range.lower) / std::log(range.upper / range.lower)
                       : (value - range.lower) / (range.upper - range.lower);
  }
  double pixelX(double value) const { return width * share(value, x, x_logarithmic); }
  double pixelY(double value) const {
    const double up = share(value, y, y_logarithmic);
    return height * (y_down ? up : 1.0 - up);
  }
  Pixel at(double a, double b) const { return {pixelX(a), pixelY(b)}; }
};

void drawLayer(const Layer& layer, const PlotArea& area, SvgCanvas& canvas);

/// Colour of a value between 0 (light) and 1 (dark): cividis, reversed. Source: Nunez et al. 2018,
/// doi:10.1371/journal.pone.0199239
std::string heatColour(double value);

/// What the colours of a heat map stand for.
Range heatRange(const HeatMap& map);

}  // namespace raven_correction
