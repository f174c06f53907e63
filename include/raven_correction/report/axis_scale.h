// SPDX-License-Identifier: BSD-3-Clause
// Limits and ticks of an axis: round numbers that a reader can interpolate between. What is drawn
// between the limits is figure.h.
#pragma once

#include <limits>
#include <string>
#include <vector>

namespace raven_correction {

/// The numbers that an axis has to show. Empty until something finite is included.
struct Range {
  double lower = std::numeric_limits<double>::infinity();
  double upper = -std::numeric_limits<double>::infinity();
  /// What is not finite is ignored.
  void include(double value) noexcept;
  void include(const Range& other) noexcept;
  bool empty() const noexcept { return !(lower <= upper); }
};

struct Tick {
  double at = 0.0;
  std::string label;
};

/// Multiples of 1, 2 or 5 times a power of ten inside the range, about `count` of them, each
/// labelled with as many decimals as tell it from its neighbours.
/// @param range  finite, lower < upper
std::vector<Tick> niceTicks(const Range& range, int count);

/// 1, 2 and 5 times powers of ten inside the range, or the powers alone where that is enough.
/// @param range  finite, 0 < lower < upper
std::vector<Tick> logarithmicTicks(const Range& range, int count);

/// With a true minus sign, and "n/a" for what is not finite.
std::string numberText(double value, int decimals);

}  // namespace raven_correction
