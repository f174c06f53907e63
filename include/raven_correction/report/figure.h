// SPDX-License-Identifier: BSD-3-Clause
// What a figure shows, as plain data: panels with two axes and layers of marks. Which limits its
// axes get is figure_limits.h, drawing it panel_svg.h and figure_html.h.
#pragma once

#include <Eigen/Core>
#include <limits>
#include <string>
#include <utility>
#include <variant>
#include <vector>

namespace raven_correction {

/// Colours that people with any colour vision tell apart, and that differ in lightness in print.
/// Nothing is said by colour alone: layers also differ in marker, stroke or filling.
/// Source: Okabe, Ito 2008, Color universal design, https://jfly.uni-koeln.de/color/
enum class Ink { kBlack, kGrey, kOrange, kSky, kGreen, kYellow, kBlue, kVermilion, kPurple };
/// "#0072B2"
const char* colourOf(Ink ink) noexcept;

enum class Marker { kCircle, kSquare, kTriangle, kDiamond };
enum class Stroke { kSolid, kDashed, kDotted };

constexpr double kUnset = std::numeric_limits<double>::quiet_NaN();

struct Axis {
  Axis() = default;
  Axis(std::string label_text, std::string unit_text)
      : label(std::move(label_text)), unit(std::move(unit_text)) {}

  std::string label;
  std::string unit;       ///< empty: a pure number
  double lower = kUnset;  ///< unset: from the data
  double upper = kUnset;
  std::vector<std::string> categories;  ///< if any, number i is where category i stands
  bool from_zero = false;               ///< whatever the data: 0 is a limit, or between them
  bool logarithmic = false;             ///< numbers above 0 only
};

/// Layers. An empty label keeps a layer out of the legend; layers of one label in several panels of
/// a figure share an entry. Numbers that are not finite are left out (bars say "n/a").
struct Points {
  std::string label;
  Ink ink = Ink::kGrey;
  Marker marker = Marker::kCircle;
  std::vector<double> x, y;
  double size = 2.5;     ///< [px]
  double opacity = 1.0;  ///< of all of them together: points do not darken one another
};
struct Line {
  std::string label;
  Ink ink = Ink::kBlack;
  Stroke stroke = Stroke::kSolid;
  std::vector<double> x, y;  ///< interrupted where not finite
  bool markers = false;
  Marker marker = Marker::kCircle;
};
/// Area between two curves, e.g. an interval.
struct Band {
  std::string label;
  Ink ink = Ink::kBlack;
  std::vector<double> x, lower, upper;
};
/// Bars from zero at `position` (of a category), each with an interval if it has one.
struct Bars {
  std::string label;
  Ink ink = Ink::kBlue;
  bool hollow = false;
  bool horizontal = false;
  std::vector<double> position, value, lower, upper;  ///< the last two may be empty
  double width = 0.7;                                 ///< [categories]
  int decimals = -1;                                  ///< of the number beside each bar; -1: none
};
struct Histogram {
  std::string label;
  Ink ink = Ink::kBlue;
  bool hollow = false;
  Stroke stroke = Stroke::kSolid;
  std::vector<double> edges;  ///< one more than counts
  std::vector<double> counts;
};
/// Quantile strips: 5 % to 95 % as a line, 25 % to 75 % as a box, the median across it.
struct Boxes {
  std::string label;
  Ink ink = Ink::kBlue;
  bool hollow = false;
  struct Quantiles {
    double p05 = kUnset, p25 = kUnset, p50 = kUnset, p75 = kUnset, p95 = kUnset;
  };
  std::vector<double> position;
  std::vector<Quantiles> quantiles;
  double width = 0.6;  ///< [categories]
};
/// Cells of a grid; light is small, dark is large. Cells that are not finite stay empty.
struct HeatMap {
  std::vector<double> x_edges, y_edges;
  Eigen::MatrixXd values;                 ///< rows along y, columns along x
  std::string label;                      ///< of the colour bar, with unit
  double lower = kUnset, upper = kUnset;  ///< of the colours; unset: from the values
  int decimals = 1;  ///< of the numbers written into cells that have room for them
};
/// A straight line across the panel, e.g. a limit.
struct Rule {
  std::string label;
  Ink ink = Ink::kBlack;
  Stroke stroke = Stroke::kDashed;
  bool vertical = false;
  double value = 0.0;
};
using Layer = std::variant<Points, Line, Band, Bars, Histogram, Boxes, HeatMap, Rule>;

/// One pair of axes.
struct Panel {
  std::string title;
  std::string description;  ///< for those who hear it instead of seeing it, beside the title;
                            ///< empty: the label of y "against" that of x
  Axis x, y;
  std::vector<Layer> layers;             ///< the first is drawn first
  double width = 440.0, height = 290.0;  ///< [px]; scales with the page
};

/// Panels side by side under one legend and one caption.
struct Figure {
  std::string title;
  std::vector<Panel> panels;
  int columns = 2;          ///< on a wide page: 1, 2 or 4
  std::string how_to_read;  ///< the caption: one or two sentences
  std::string good;         ///< what it looks like when all is well
};

/// Five quantiles of a list; all unset for an empty one. What is not finite is left out.
Boxes::Quantiles quantilesOf(const std::vector<double>& values);

/// Which share of the values [%] is at most as large, in 120 steps of equal share: reads the median
/// at 50 %. What is not finite is left out.
Line cumulativeOf(const std::vector<double>& values);

/// Counts in `bins` equal bins between the limits; what lies outside is counted in the outermost
/// bins, so that none is lost.
Histogram histogramOf(const std::vector<double>& values, double lower, double upper, int bins);

/// Median and quartiles of y in `bins` bins of x with about equally many points each, drawn as a
/// line with a band. Bins of fewer than three points are left out.
struct Trend {
  Line median;
  Band quartiles;
};
Trend trendOf(const std::vector<double>& x, const std::vector<double>& y, int bins);

}  // namespace raven_correction
