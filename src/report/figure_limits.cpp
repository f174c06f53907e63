// SPDX-License-Identifier: BSD-3-Clause
#include "raven_correction/report/figure_limits.h"

#include <algorithm>
#include <cmath>

#include "raven_correction/geometry/statistics.h"

namespace raven_correction {
namespace {

constexpr double kMargin = 0.04;      // of the range of the data, on either side [-]
constexpr double kNumberRoom = 0.22;  // of the range of bars, for the numbers beside them [-]

void includeAll(Range& range, const std::vector<double>& values) {
  for (const double value : values) range.include(value);
}

/// What the marks of one panel cover.
struct Extent {
  Range x, y;
  bool x_from_zero = false, y_from_zero = false;  // lengths count from zero there

  void operator()(const Points& layer) { both(layer.x, layer.y); }
  void operator()(const Line& layer) { both(layer.x, layer.y); }
  void operator()(const Band& layer) {
    both(layer.x, layer.lower);
    both(layer.x, layer.upper);
  }
  void operator()(const Bars& layer) {
    Range& along = layer.horizontal ? x : y;
    Range& across = layer.horizontal ? y : x;
    (layer.horizontal ? x_from_zero : y_from_zero) = true;
    along.include(0.0);
    includeAll(along, layer.value);
    includeAll(along, layer.lower);
    includeAll(along, layer.upper);
    if (layer.decimals >= 0) {
      Range own;
      own.include(0.0);
      includeAll(own, layer.value);
      includeAll(own, layer.upper);
      along.include(own.upper + kNumberRoom * (own.upper - own.lower));
    }
    for (const double position : layer.position) {
      across.include(position - 0.5);
      across.include(position + 0.5);
    }
  }
  void operator()(const Histogram& layer) {
    y_from_zero = true;
    y.include(0.0);
    includeAll(x, layer.edges);
    includeAll(y, layer.counts);
  }
  void operator()(const Boxes& layer) {
    for (const Boxes::Quantiles& q : layer.quantiles) includeAll(y, {q.p05, q.p50, q.p95});
    for (const double position : layer.position) {
      x.include(position - 0.5);
      x.include(position + 0.5);
    }
  }
  void operator()(const HeatMap& layer) {
    includeAll(x, layer.x_edges);
    includeAll(y, layer.y_edges);
  }
  void operator()(const Rule& layer) { (layer.vertical ? x : y).include(layer.value); }

 private:
  void both(const std::vector<double>& a, const std::vector<double>& b) {
    for (std::size_t i = 0; i < std::min(a.size(), b.size()); ++i) {
      if (!std::isfinite(a[i]) || !std::isfinite(b[i])) continue;
      x.include(a[i]);
      y.include(b[i]);
    }
  }
};

Extent extentOf(const Panel& panel) {
  Extent extent;
  for (const Layer& layer : panel.layers) std::visit([&](const auto& l) { extent(l); }, layer);
  return extent;
}

bool isFilled(const Panel& panel) {
  return std::any_of(panel.layers.begin(), panel.layers.end(),
                     [](const Layer& layer) { return std::holds_alternative<HeatMap>(layer); });
}

/// Whole factors of the data; what is not above zero cannot be shown.
Range finishLogarithmic(const Axis& axis, Range data) {
  const double margin = 1.1, widest = 1e4;
  if (data.empty() || !(data.upper > 0.0)) data = {1.0, 10.0};
  Range range{std::max(data.lower, data.upper / widest) / margin, data.upper * margin};
  if (axis.lower > 0.0) range.lower = axis.lower;
  if (axis.upper > 0.0) range.upper = axis.upper;
  if (!(range.lower < range.upper)) range.upper = 10.0 * range.lower;
  return range;
}

Range finish(const Axis& axis, Range data, bool from_zero, bool filled) {
  if (!axis.categories.empty()) return {-0.5, static_cast<double>(axis.categories.size()) - 0.5};
  if (axis.logarithmic) return finishLogarithmic(axis, data);
  if (axis.from_zero) data.include(0.0);
  const bool zero = from_zero || axis.from_zero;
  if (data.empty()) data = {0.0, 1.0};
  if (!(data.lower < data.upper)) {
    const double half = data.lower == 0.0 ? 0.5 : 0.1 * std::abs(data.lower);
    data = {data.lower - half, data.upper + half};
  }
  const double margin = filled ? 0.0 : kMargin * (data.upper - data.lower);
  Range range{zero && data.lower == 0.0 ? 0.0 : data.lower - margin,
              zero && data.upper == 0.0 ? 0.0 : data.upper + margin};
  if (std::isfinite(axis.lower)) range.lower = axis.lower;
  if (std::isfinite(axis.upper)) range.upper = axis.upper;
  if (!(range.lower < range.upper)) range.upper = range.lower + 1.0;
  return range;
}

}  // namespace

PanelLimits limitsOf(const Panel& panel) {
  const Extent extent = extentOf(panel);
  PanelLimits limits;
  limits.empty = extent.x.empty() || extent.y.empty();
  const bool filled = isFilled(panel);
  limits.x = finish(panel.x, extent.x, extent.x_from_zero, filled);
  limits.y = finish(panel.y, extent.y, extent.y_from_zero, filled);
  return limits;
}

void shareLimits(std::vector<Panel*> panels, bool share_x, bool share_y) {
  Range x, y;
  for (const Panel* const panel : panels) {
    const PanelLimits limits = limitsOf(*panel);
    if (limits.empty) continue;
    x.include(limits.x);
    y.include(limits.y);
  }
  const auto set = [](Axis& axis, const Range& range) {
    if (range.empty() || !axis.categories.empty()) return;
    axis.lower = range.lower;
    axis.upper = range.upper;
  };
  for (Panel* const panel : panels) {
    if (share_x) set(panel->x, x);
    if (share_y) set(panel->y, y);
  }
}

void shareColours(std::vector<Panel*> panels) {
  Range range;
  const auto each = [&](auto&& action) {
    for (Panel* const panel : panels)
      for (Layer& layer : panel->layers)
        if (HeatMap* const heat = std::get_if<HeatMap>(&layer)) action(*heat);
  };
  each([&](const HeatMap& heat) {
    for (Eigen::Index i = 0; i < heat.values.size(); ++i) range.include(heat.values.data()[i]);
  });
  if (range.empty()) return;
  each([&](HeatMap& heat) {
    heat.lower = range.lower;
    heat.upper = range.upper;
  });
}

std::size_t limitTo(Axis& axis, const std::vector<double>& values, double share) {
  std::vector<double> finite;
  std::copy_if(values.begin(), values.end(), std::back_inserter(finite),
               [](double v) { return std::isfinite(v); });
  if (finite.empty()) return 0;
  const double tail = 0.5 * (1.0 - share);
  const double lower = quantile(finite, tail), upper = quantile(finite, 1.0 - tail);
  if (!(lower < upper)) return 0;
  if (axis.logarithmic) {
    axis.lower = std::max(lower, upper * 1e-6) / (1.0 + kMargin);
    axis.upper = upper * (1.0 + kMargin);
  } else {
    const double margin = kMargin * (upper - lower);
    axis.lower = lower - margin;
    axis.upper = upper + margin;
  }
  return static_cast<std::size_t>(std::count_if(
      finite.begin(), finite.end(), [&](double v) { return v < axis.lower || v > axis.upper; }));
}

}  // namespace raven_correction
