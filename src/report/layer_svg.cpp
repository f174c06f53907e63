// SPDX-License-Identifier: BSD-3-Clause
#include "layer_svg.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "raven_correction/error.h"

namespace raven_correction {
namespace {

constexpr double kLineWidth = 1.8;   // [px]
constexpr double kMarkerSize = 6.0;  // of lines with markers [px]
constexpr double kFaint = 0.22;      // of a band [-]
constexpr double kLabelSize = 10.0;  // of numbers beside bars and in cells [px]
constexpr double kCap = 3.0;         // half length of the end of an interval [px]

double element(const std::vector<double>& values, std::size_t i) {
  return i < values.size() ? values[i] : kUnset;
}

/// Draws one kind of layer after the other.
class Painter {
 public:
  Painter(const PlotArea& area, SvgCanvas& canvas) : area_(area), canvas_(canvas) {}

  void operator()(const Points& layer) {
    std::vector<Pixel> visible;
    for (std::size_t i = 0; i < std::min(layer.x.size(), layer.y.size()); ++i) {
      const Pixel pixel = area_.at(layer.x[i], layer.y[i]);
      if (isInside(pixel)) visible.push_back(pixel);
    }
    canvas_.dots(visible, layer.marker, layer.size, colourOf(layer.ink), layer.opacity);
  }

  void operator()(const Line& layer) {
    std::vector<Pixel> points;
    for (std::size_t i = 0; i < std::min(layer.x.size(), layer.y.size()); ++i)
      points.push_back(area_.at(layer.x[i], layer.y[i]));
    canvas_.path(polyline(points), {colourOf(layer.ink), "none", kLineWidth, layer.stroke});
    if (layer.markers) canvas_.dots(points, layer.marker, kMarkerSize, colourOf(layer.ink), 1.0);
  }

  void operator()(const Band& layer) {
    std::vector<Pixel> upper, lower;
    const auto flush = [&] {
      std::vector<Pixel> outline = upper;
      outline.insert(outline.end(), lower.rbegin(), lower.rend());
      if (upper.size() > 1)
        canvas_.path(polyline(outline) + "Z", {"none", colourOf(layer.ink), 1.0, {}, kFaint});
      upper.clear();
      lower.clear();
    };
    for (std::size_t i = 0; i < layer.x.size(); ++i) {
      const Pixel below = area_.at(layer.x[i], element(layer.lower, i));
      const Pixel above = area_.at(layer.x[i], element(layer.upper, i));
      if (!isFinite(below) || !isFinite(above)) {
        flush();
        continue;
      }
      lower.push_back(below);
      upper.push_back(above);
    }
    flush();
  }

  void operator()(const Bars& layer) {
    for (std::size_t i = 0; i < std::min(layer.position.size(), layer.value.size()); ++i)
      drawBar(layer, i);
  }

  void operator()(const Histogram& layer) {
    if (layer.edges.size() != layer.counts.size() + 1 || layer.counts.empty()) return;
    std::vector<Pixel> outline{area_.at(layer.edges.front(), 0.0)};
    for (std::size_t i = 0; i < layer.counts.size(); ++i) {
      outline.push_back(area_.at(layer.edges[i], layer.counts[i]));
      outline.push_back(area_.at(layer.edges[i + 1], layer.counts[i]));
    }
    outline.push_back(area_.at(layer.edges.back(), 0.0));
    const std::string data = polyline(outline);
    if (!layer.hollow && !data.empty())
      canvas_.path(data + "Z", {"none", colourOf(layer.ink), 1.0, {}, 0.35});
    canvas_.path(data, {colourOf(layer.ink), "none", kLineWidth, layer.stroke});
  }

  void operator()(const Boxes& layer) {
    for (std::size_t i = 0; i < std::min(layer.position.size(), layer.quantiles.size()); ++i) {
      const Boxes::Quantiles& q = layer.quantiles[i];
      if (!std::isfinite(q.p50)) continue;
      const char* const colour = colourOf(layer.ink);
      const double x = area_.pixelX(layer.position[i]);
      const double left = area_.pixelX(layer.position[i] - 0.5 * layer.width);
      const double right = area_.pixelX(layer.position[i] + 0.5 * layer.width);
      canvas_.line({x, area_.pixelY(q.p05)}, {x, area_.pixelY(q.p95)}, {colour, "none", 1.4});
      for (const double end : {q.p05, q.p95})
        canvas_.line({x - kCap, area_.pixelY(end)}, {x + kCap, area_.pixelY(end)},
                     {colour, "none", 1.4});
      const double top = area_.pixelY(q.p75);
      canvas_.rectangle({left, top}, right - left, std::max(1.0, area_.pixelY(q.p25) - top),
                        {colour, layer.hollow ? "#FFFFFF" : colour, 1.4});
      const double middle = area_.pixelY(q.p50);
      canvas_.line({left, middle}, {right, middle},
                   {layer.hollow ? colour : "#FFFFFF", "none", 2.4});
    }
  }

  void operator()(const HeatMap& layer) {
    const Range range = heatRange(layer);
    if (range.empty()) return;
    for (Eigen::Index row = 0; row < layer.values.rows(); ++row)
      for (Eigen::Index column = 0; column < layer.values.cols(); ++column)
        drawCell(layer, range, row, column);
  }

  void operator()(const Rule& layer) {
    const Paint paint{colourOf(layer.ink), "none", 1.3, layer.stroke};
    if (layer.vertical)
      canvas_.line({area_.pixelX(layer.value), 0.0}, {area_.pixelX(layer.value), area_.height},
                   paint);
    else
      canvas_.line({0.0, area_.pixelY(layer.value)}, {area_.width, area_.pixelY(layer.value)},
                   paint);
  }

 private:
  bool isInside(const Pixel& pixel) const {
    const double room = 4.0;  // half a mark may stand out
    return pixel.x > -room && pixel.x < area_.width + room && pixel.y > -room &&
           pixel.y < area_.height + room;
  }

  Pixel place(const Bars& layer, double along, double across) const {
    return layer.horizontal ? area_.at(along, across) : area_.at(across, along);
  }

  void drawBar(const Bars& layer, std::size_t i) {
    const double value = layer.value[i], position = layer.position[i];
    if (!std::isfinite(value)) {
      label(layer, 0.0, position, "n/a");
      return;
    }
    const Pixel a = place(layer, 0.0, position - 0.5 * layer.width);
    const Pixel b = place(layer, value, position + 0.5 * layer.width);
    const char* const colour = colourOf(layer.ink);
    canvas_.rectangle({std::min(a.x, b.x), std::min(a.y, b.y)}, std::abs(b.x - a.x),
                      std::abs(b.y - a.y), {colour, layer.hollow ? "#FFFFFF" : colour, 1.4});
    const double lower = element(layer.lower, i), upper = element(layer.upper, i);
    double end = std::max(0.0, value);
    if (std::isfinite(lower) && std::isfinite(upper)) {
      const Paint paint{colourOf(Ink::kBlack), "none", 1.4};
      canvas_.line(place(layer, lower, position), place(layer, upper, position), paint);
      for (const double tip : {lower, upper}) {
        const Pixel at = place(layer, tip, position);
        if (layer.horizontal)
          canvas_.line({at.x, at.y - kCap}, {at.x, at.y + kCap}, paint);
        else
          canvas_.line({at.x - kCap, at.y}, {at.x + kCap, at.y}, paint);
      }
      end = std::max(end, upper);
    }
    if (layer.decimals >= 0) label(layer, end, position, numberText(value, layer.decimals));
  }

  void label(const Bars& layer, double along, double position, const std::string& words) {
    const Pixel at = place(layer, along, position);
    if (layer.horizontal)
      canvas_.text({at.x + 6.0, at.y + 0.35 * kLabelSize}, words, "start", kLabelSize);
    else
      canvas_.text({at.x, at.y - 5.0}, words, "middle", kLabelSize);
  }

  void drawCell(const HeatMap& layer, const Range& range, Eigen::Index row, Eigen::Index column) {
    const double value = layer.values(row, column);
    const auto r = static_cast<std::size_t>(row), c = static_cast<std::size_t>(column);
    if (!std::isfinite(value) || r + 1 >= layer.y_edges.size() || c + 1 >= layer.x_edges.size())
      return;
    const Pixel a = area_.at(layer.x_edges[c], layer.y_edges[r]);
    const Pixel b = area_.at(layer.x_edges[c + 1], layer.y_edges[r + 1]);
    const double width = std::abs(b.x - a.x), height = std::abs(b.y - a.y);
    const double span = range.upper - range.lower;
    const double share = span > 0.0 ? (value - range.lower) / span : 0.0;
    canvas_.rectangle({std::min(a.x, b.x), std::min(a.y, b.y)}, width, height,
                      {"#FFFFFF", heatColour(share), 0.5});
    const std::string words = numberText(value, layer.decimals);
    if (textWidth(words, kLabelSize) + 3.0 > width || kLabelSize + 3.0 > height) return;
    canvas_.text({0.5 * (a.x + b.x), 0.5 * (a.y + b.y) + 0.35 * kLabelSize}, words, "middle",
                 kLabelSize, share > 0.5 ? "#FFFFFF" : "#222222");
  }

  const PlotArea& area_;
  SvgCanvas& canvas_;
};

}  // namespace

void drawLayer(const Layer& layer, const PlotArea& area, SvgCanvas& canvas) {
  std::visit(Painter(area, canvas), layer);
}

std::string heatColour(double value) {
  using Colour = std::array<double, 3>;
  static constexpr std::array<Colour, 6> kStops{{{255, 234, 70},
                                                 {213, 192, 99},
                                                 {166, 157, 117},
                                                 {124, 123, 120},
                                                 {65, 77, 107},
                                                 {0, 32, 77}}};
  const double at = std::clamp(value, 0.0, 1.0) * static_cast<double>(kStops.size() - 1);
  const std::size_t i = std::min(kStops.size() - 2, static_cast<std::size_t>(at));
  const double t = at - static_cast<double>(i);
  const auto mix = [&](std::size_t k) {
    return static_cast<int>(std::lround((1.0 - t) * kStops[i][k] + t * kStops[i + 1][k]));
  };
  return format("#%02X%02X%02X", mix(0), mix(1), mix(2));
}

Range heatRange(const HeatMap& map) {
  Range range;
  for (Eigen::Index i = 0; i < map.values.size(); ++i) range.include(map.values.data()[i]);
  if (range.empty()) return range;
  if (std::isfinite(map.lower)) range.lower = map.lower;
  if (std::isfinite(map.upper)) range.upper = map.upper;
  return range;
}

}  // namespace raven_correction
