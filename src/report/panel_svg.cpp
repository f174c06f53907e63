// SPDX-License-Identifier: BSD-3-Clause
#include "raven_correction/report/panel_svg.h"

#include <algorithm>
#include <cmath>

#include "layer_svg.h"
#include "raven_correction/report/xml_text.h"
#include "svg_canvas.h"

namespace raven_correction {
namespace {

constexpr double kTextSize = 11.0;   // [px]
constexpr double kTitleSize = 12.0;  // [px]
constexpr double kTickLength = 4.0;  // [px]
constexpr double kTilt = -35.0;      // of categories that would run into one another [deg]
constexpr double kWide = 600.0;      // a wider panel has a row of its own [px]
constexpr double kColourBar = 62.0;  // room for it [px]
constexpr char kFrame[] = "#555555";
constexpr char kGrid[] = "#E4E4E4";

std::string labelOf(const Axis& axis) {
  if (axis.unit.empty()) return axis.label;
  return axis.label + (axis.label.empty() ? "[" : " [") + axis.unit + "]";
}

std::vector<Tick> ticksOf(const Axis& axis, const Range& range, double length, double spacing) {
  const int count = std::max(2, static_cast<int>(length / spacing));
  if (axis.categories.empty())
    return axis.logarithmic ? logarithmicTicks(range, count) : niceTicks(range, count);
  std::vector<Tick> ticks;
  for (std::size_t i = 0; i < axis.categories.size(); ++i)
    ticks.push_back({static_cast<double>(i), axis.categories[i]});
  return ticks;
}

double widest(const std::vector<Tick>& ticks) {
  double width = 0.0;
  for (const Tick& tick : ticks) width = std::max(width, textWidth(tick.label, kTextSize));
  return width;
}

const HeatMap* heatMapOf(const Panel& panel) {
  for (const Layer& layer : panel.layers)
    if (const HeatMap* const heat = std::get_if<HeatMap>(&layer)) return heat;
  return nullptr;
}

/// Frame, ticks and words around the plot area.
class PanelWriter {
 public:
  explicit PanelWriter(const Panel& panel) : panel_(panel), limits_(limitsOf(panel)) { layOut(); }

  std::string write() {
    open();
    drawGrid();
    drawMarks();
    drawFrame();
    drawTicksAlongX();
    drawTicksAlongY();
    drawLabels();
    if (const HeatMap* const heat = heatMapOf(panel_)) drawColourBar(*heat);
    canvas_.raw("</svg>");
    return canvas_.take();
  }

 private:
  void layOut() {
    area_.x = limits_.x;
    area_.y = limits_.y;
    area_.y_down = !panel_.y.categories.empty();
    area_.x_logarithmic = panel_.x.logarithmic;
    area_.y_logarithmic = panel_.y.logarithmic;
    top_ = panel_.title.empty() ? 10.0 : 28.0;
    bottom_ = kTickLength + kTextSize + 6.0 + (labelOf(panel_.x).empty() ? 0.0 : 18.0);
    right_ = heatMapOf(panel_) ? kColourBar : 12.0;
    y_ticks_ = ticksOf(panel_.y, area_.y, panel_.height - top_ - bottom_, 38.0);
    left_ = 8.0 + kTickLength + widest(y_ticks_) + (labelOf(panel_.y).empty() ? 0.0 : 20.0);
    area_.width = std::max(20.0, panel_.width - left_ - right_);
    x_ticks_ = ticksOf(panel_.x, area_.x, area_.width, 62.0);
    if (panel_.x.categories.empty()) {  // the last number may stand at the edge
      const double more = std::max(0.0, 0.5 * widest(x_ticks_) + 2.0 - right_);
      right_ += more;
      area_.width -= more;
    }
    const double room = area_.width / std::max<double>(1.0, static_cast<double>(x_ticks_.size()));
    tilted_ = !panel_.x.categories.empty() && widest(x_ticks_) + 4.0 > room;
    if (tilted_) bottom_ += 0.6 * widest(x_ticks_);
    area_.height = std::max(20.0, panel_.height - top_ - bottom_);
  }

  void open() {
    const std::string width = pixels(panel_.width), height = pixels(panel_.height);
    const std::string title = xmlText(panel_.title);
    const std::string what = panel_.description.empty()
                                 ? labelOf(panel_.y) + " against " + labelOf(panel_.x)
                                 : panel_.description;
    canvas_.raw(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" role=\"img\" viewBox=\"0 0 " + width + " " +
        height + "\" width=\"" + width + "\" height=\"" + height + "\"" +
        (panel_.width > kWide ? " style=\"max-width:" + width + "px;grid-column:1/-1\"" : "") +
        " font-family=\"sans-serif\"><title>" + title + "</title><desc>" + xmlText(what) +
        "</desc>");
    canvas_.rectangle({0.0, 0.0}, panel_.width, panel_.height, {"none", "#FFFFFF"});
  }

  void drawGrid() {
    const Paint paint{kGrid, "none", 1.0};
    if (heatMapOf(panel_)) return;
    for (const Tick& tick : x_ticks_)
      if (panel_.x.categories.empty())
        canvas_.line({x(tick.at), top_}, {x(tick.at), top_ + area_.height}, paint);
    for (const Tick& tick : y_ticks_)
      if (panel_.y.categories.empty())
        canvas_.line({left_, y(tick.at)}, {left_ + area_.width, y(tick.at)}, paint);
    const Paint zero{"#9A9A9A", "none", 1.0};
    const auto within = [](const Range& range) { return range.lower < 0.0 && range.upper > 0.0; };
    if (panel_.y.categories.empty() && !panel_.y.logarithmic && within(area_.y))
      canvas_.line({left_, y(0.0)}, {left_ + area_.width, y(0.0)}, zero);
    if (panel_.x.categories.empty() && !panel_.x.logarithmic && within(area_.x))
      canvas_.line({x(0.0), top_}, {x(0.0), top_ + area_.height}, zero);
  }

  /// A nested <svg> cuts off what lies outside, without a name that another figure might have.
  void drawMarks() {
    canvas_.raw("<svg x=\"" + pixels(left_) + "\" y=\"" + pixels(top_) + "\" width=\"" +
                pixels(area_.width) + "\" height=\"" + pixels(area_.height) +
                "\" overflow=\"hidden\">");
    for (const Layer& layer : panel_.layers) drawLayer(layer, area_, canvas_);
    if (limits_.empty)
      canvas_.text({0.5 * area_.width, 0.5 * area_.height}, "no data", "middle", kTitleSize,
                   kFrame);
    canvas_.raw("</svg>");
  }

  void drawFrame() {
    canvas_.rectangle({left_, top_}, area_.width, area_.height, {kFrame, "none", 1.0});
  }

  void drawTicksAlongX() {
    const double floor = top_ + area_.height;
    for (const Tick& tick : x_ticks_) {
      const double at = x(tick.at);
      canvas_.line({at, floor}, {at, floor + kTickLength}, {kFrame, "none", 1.0});
      if (tilted_)
        canvas_.text({at + 4.0, floor + kTickLength + kTextSize}, tick.label, "end", kTextSize,
                     "#222222", kTilt);
      else
        canvas_.text({at, floor + kTickLength + kTextSize + 1.0}, tick.label, "middle", kTextSize);
    }
  }

  void drawTicksAlongY() {
    for (const Tick& tick : y_ticks_) {
      const double at = y(tick.at);
      canvas_.line({left_ - kTickLength, at}, {left_, at}, {kFrame, "none", 1.0});
      canvas_.text({left_ - kTickLength - 3.0, at + 0.36 * kTextSize}, tick.label, "end",
                   kTextSize);
    }
  }

  void drawLabels() {
    const std::string along = labelOf(panel_.x), up = labelOf(panel_.y);
    if (!panel_.title.empty())
      canvas_.text({left_, 17.0}, panel_.title, "start", kTitleSize, "#111111", 0.0, true);
    if (!along.empty()) {
      // Under the middle of the axis, but never over the edge of the picture.
      const double half = 0.5 * textWidth(along, kTextSize) + 2.0;
      const double middle = std::min(left_ + 0.5 * area_.width, panel_.width - half);
      canvas_.text({std::max(middle, half), panel_.height - 6.0}, along, "middle", kTextSize);
    }
    if (!up.empty())
      canvas_.text({13.0, top_ + 0.5 * area_.height}, up, "middle", kTextSize, "#222222", -90.0);
  }

  void drawColourBar(const HeatMap& heat) {
    const Range range = heatRange(heat);
    if (range.empty()) return;
    const int steps = 24;
    const double width = 10.0;
    const double x0 = left_ + area_.width + 8.0;
    for (int i = 0; i < steps; ++i)
      canvas_.rectangle({x0, top_ + area_.height * (steps - 1 - i) / steps}, width,
                        area_.height / steps + 0.5, {"none", heatColour((i + 0.5) / steps)});
    canvas_.rectangle({x0, top_}, width, area_.height, {kFrame, "none", 1.0});
    Range shown = range;
    if (!(shown.lower < shown.upper)) shown.upper = shown.lower + 1.0;
    for (const Tick& tick : niceTicks(shown, 5)) {
      const double at =
          top_ + area_.height * (1.0 - (tick.at - shown.lower) / (shown.upper - shown.lower));
      canvas_.text({x0 + width + 3.0, at + 0.36 * kTextSize}, tick.label, "start", kTextSize);
    }
    canvas_.text({panel_.width - 3.0, top_ + 0.5 * area_.height}, heat.label, "middle", kTextSize,
                 "#222222", -90.0);
  }

  double x(double value) const { return left_ + area_.pixelX(value); }
  double y(double value) const { return top_ + area_.pixelY(value); }

  const Panel& panel_;
  const PanelLimits limits_;
  PlotArea area_;
  double left_ = 0.0, right_ = 0.0, top_ = 0.0, bottom_ = 0.0;
  bool tilted_ = false;
  std::vector<Tick> x_ticks_, y_ticks_;
  SvgCanvas canvas_;
};

/// A small picture of every kind of layer.
struct Swatch {
  SvgCanvas& canvas;
  void operator()(const Points& layer) const {
    canvas.dots({{7.0, 6.0}, {17.0, 6.0}}, layer.marker, std::clamp(layer.size, 4.0, 7.0),
                colourOf(layer.ink), layer.opacity < 0.6 ? 0.6 : layer.opacity);
  }
  void operator()(const Line& layer) const {
    canvas.line({0.0, 6.0}, {24.0, 6.0}, {colourOf(layer.ink), "none", 2.0, layer.stroke});
    if (layer.markers) canvas.dots({{12.0, 6.0}}, layer.marker, 6.0, colourOf(layer.ink), 1.0);
  }
  void operator()(const Band& layer) const {
    canvas.rectangle({1.0, 1.0}, 22.0, 10.0, {"none", colourOf(layer.ink), 1.0, {}, 0.3});
  }
  void operator()(const Bars& layer) const { box(layer.ink, layer.hollow); }
  void operator()(const Histogram& layer) const {
    const char* const colour = colourOf(layer.ink);
    if (!layer.hollow) canvas.rectangle({1.0, 1.0}, 22.0, 10.0, {"none", colour, 1.0, {}, 0.35});
    canvas.rectangle({1.0, 1.0}, 22.0, 10.0, {colour, "none", 1.6, layer.stroke});
  }
  void operator()(const Boxes& layer) const {
    canvas.line({0.0, 6.0}, {24.0, 6.0}, {colourOf(layer.ink), "none", 1.4});
    canvas.rectangle({6.0, 1.5}, 12.0, 9.0,
                     {colourOf(layer.ink), layer.hollow ? "#FFFFFF" : colourOf(layer.ink), 1.4});
  }
  void operator()(const HeatMap& /*layer*/) const {
    for (int i = 0; i < 4; ++i)
      canvas.rectangle({6.0 * i, 1.0}, 6.5, 10.0, {"none", heatColour((i + 0.5) / 4.0)});
  }
  void operator()(const Rule& layer) const {
    canvas.line({0.0, 6.0}, {24.0, 6.0}, {colourOf(layer.ink), "none", 1.6, layer.stroke});
  }

 private:
  void box(Ink ink, bool hollow) const {
    canvas.rectangle({2.0, 1.5}, 20.0, 9.0,
                     {colourOf(ink), hollow ? "#FFFFFF" : colourOf(ink), 1.4});
  }
};

}  // namespace

std::string panelSvg(const Panel& panel) { return PanelWriter(panel).write(); }

std::string swatchSvg(const Layer& layer) {
  SvgCanvas canvas;
  canvas.raw(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" aria-hidden=\"true\" viewBox=\"0 0 24 12\" "
      "width=\"24\" height=\"12\">");
  std::visit(Swatch{canvas}, layer);
  canvas.raw("</svg>");
  return canvas.take();
}

}  // namespace raven_correction
