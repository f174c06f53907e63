// SPDX-License-Identifier: BSD-3-Clause
#include "raven_correction/report/figure.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "raven_correction/geometry/statistics.h"

namespace raven_correction {

const char* colourOf(Ink ink) noexcept {
  switch (ink) {
    case Ink::kBlack:
      return "#222222";
    case Ink::kGrey:
      return "#8C8C8C";
    case Ink::kOrange:
      return "#E69F00";
    case Ink::kSky:
      return "#56B4E9";
    case Ink::kGreen:
      return "#009E73";
    case Ink::kYellow:
      return "#F0E442";
    case Ink::kBlue:
      return "#0072B2";
    case Ink::kVermilion:
      return "#D55E00";
    case Ink::kPurple:
      return "#CC79A7";
  }
  return "#222222";
}

namespace {

std::vector<double> finiteSorted(const std::vector<double>& values) {
  std::vector<double> finite;
  std::copy_if(values.begin(), values.end(), std::back_inserter(finite),
               [](double v) { return std::isfinite(v); });
  std::sort(finite.begin(), finite.end());
  return finite;
}

}  // namespace

Line cumulativeOf(const std::vector<double>& values) {
  const std::size_t steps = 120;
  const std::vector<double> sorted = finiteSorted(values);
  Line line;
  for (std::size_t i = 0; i <= steps && !sorted.empty(); ++i) {
    const std::size_t k = std::min(sorted.size() - 1, sorted.size() * i / steps);
    line.x.push_back(sorted[k]);
    line.y.push_back(100.0 * static_cast<double>(k + 1) / static_cast<double>(sorted.size()));
  }
  return line;
}

Boxes::Quantiles quantilesOf(const std::vector<double>& values) {
  const std::vector<double> finite = finiteSorted(values);
  if (finite.empty()) return {};
  return {quantile(finite, 0.05), quantile(finite, 0.25), quantile(finite, 0.5),
          quantile(finite, 0.75), quantile(finite, 0.95)};
}

Histogram histogramOf(const std::vector<double>& values, double lower, double upper, int bins) {
  Histogram histogram;
  for (int i = 0; i <= bins; ++i) histogram.edges.push_back(lower + (upper - lower) * i / bins);
  histogram.counts.assign(static_cast<std::size_t>(bins), 0.0);
  for (const double value : values) {
    if (!std::isfinite(value)) continue;
    const double bin = std::floor((value - lower) / (upper - lower) * bins);
    const double inside = std::clamp(bin, 0.0, static_cast<double>(bins - 1));
    histogram.counts[static_cast<std::size_t>(inside)] += 1.0;
  }
  return histogram;
}

Trend trendOf(const std::vector<double>& x, const std::vector<double>& y, int bins) {
  const std::size_t least = 3;
  std::vector<std::size_t> order;
  for (std::size_t i = 0; i < x.size(); ++i)
    if (std::isfinite(x[i]) && std::isfinite(y[i])) order.push_back(i);
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return x[a] < x[b]; });
  Trend trend;
  for (int bin = 0; bin < bins; ++bin) {
    const std::size_t begin = order.size() * static_cast<std::size_t>(bin) / bins;
    const std::size_t end = order.size() * static_cast<std::size_t>(bin + 1) / bins;
    if (end - begin < least) continue;
    std::vector<double> at, values;
    for (std::size_t i = begin; i < end; ++i) {
      at.push_back(x[order[i]]);
      values.push_back(y[order[i]]);
    }
    trend.median.x.push_back(median(at));
    trend.median.y.push_back(median(values));
    trend.quartiles.x.push_back(trend.median.x.back());
    trend.quartiles.lower.push_back(quantile(values, 0.25));
    trend.quartiles.upper.push_back(quantile(values, 0.75));
  }
  return trend;
}

}  // namespace raven_correction
