// SPDX-License-Identifier: BSD-3-Clause
#include "raven_correction/report/axis_scale.h"

#include <algorithm>
#include <cmath>

#include "raven_correction/error.h"

namespace raven_correction {
namespace {

constexpr char kMinus[] = "\xE2\x88\x92";  // U+2212
constexpr int kMostDecimals = 6;           // beyond: powers of ten

double niceStep(double rough) {
  const double power = std::pow(10.0, std::floor(std::log10(rough)));
  const double mantissa = rough / power;
  return power * (mantissa < 1.5 ? 1.0 : mantissa < 3.5 ? 2.0 : mantissa < 7.5 ? 5.0 : 10.0);
}

std::string withTrueMinus(const std::string& text) {
  return text[0] == '-' ? kMinus + text.substr(1) : text;
}

}  // namespace

void Range::include(double value) noexcept {
  if (!std::isfinite(value)) return;
  lower = std::min(lower, value);
  upper = std::max(upper, value);
}

void Range::include(const Range& other) noexcept {
  include(other.lower);
  include(other.upper);
}

std::vector<Tick> niceTicks(const Range& range, int count) {
  const double step = niceStep((range.upper - range.lower) / std::max(1, count));
  const int decimals = std::max(0, -static_cast<int>(std::floor(std::log10(step) + 1e-9)));
  const bool powers = decimals > kMostDecimals || std::abs(range.upper) >= 1e7;
  std::vector<Tick> ticks;
  const double slack = 1e-9 * step;
  for (double k = std::ceil((range.lower - slack) / step); k * step <= range.upper + slack; ++k) {
    const double at = k == 0.0 ? 0.0 : k * step;
    ticks.push_back({at, powers ? withTrueMinus(format("%.3g", at)) : numberText(at, decimals)});
  }
  return ticks;
}

std::vector<Tick> logarithmicTicks(const Range& range, int count) {
  const double decades = std::log10(range.upper / range.lower);
  const bool powers_alone = decades * 3.0 > 2.0 * count;
  std::vector<Tick> ticks;
  const auto first = static_cast<int>(std::floor(std::log10(range.lower)));
  const auto last = static_cast<int>(std::ceil(std::log10(range.upper)));
  for (int k = first; k <= last; ++k)
    for (const double mantissa : {1.0, 2.0, 5.0}) {
      const double at = mantissa * std::pow(10.0, k);
      if (powers_alone && mantissa > 1.0) continue;
      if (at >= range.lower * (1.0 - 1e-9) && at <= range.upper * (1.0 + 1e-9))
        ticks.push_back({at, format("%g", at)});
    }
  return ticks;
}

std::string numberText(double value, int decimals) {
  if (!std::isfinite(value)) return "n/a";
  const std::string text = format("%.*f", decimals, value);
  const bool zero = text.find_first_of("123456789") == std::string::npos;
  return zero && text[0] == '-' ? text.substr(1) : withTrueMinus(text);
}

}  // namespace raven_correction
