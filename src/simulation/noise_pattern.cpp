// SPDX-License-Identifier: BSD-3-Clause
#include "noise_pattern.h"

#include <cmath>
#include <cstddef>
#include <random>

namespace raven_correction {
namespace {

double smoothStep(double t) { return t * t * (3.0 - 2.0 * t); }

}  // namespace

NoisePattern::NoisePattern(int cells, int octaves, unsigned seed)
    : values_(static_cast<std::size_t>(kSize * kSize), 0.0f) {
  std::mt19937 random(seed);
  double weight = 1.0;
  for (int octave = 0; octave < octaves; ++octave, cells *= 2, weight *= 0.5) {
    std::vector<double> knots(static_cast<std::size_t>(cells * cells));
    for (double& knot : knots) knot = std::normal_distribution<double>()(random);
    const auto knot = [&](int i, int j) {
      return knots[static_cast<std::size_t>((i % cells) * cells + j % cells)];
    };
    for (int y = 0; y < kSize; ++y)
      for (int x = 0; x < kSize; ++x) {
        const double fx = static_cast<double>(x) * cells / kSize;
        const double fy = static_cast<double>(y) * cells / kSize;
        const int i = static_cast<int>(fy);
        const int j = static_cast<int>(fx);
        const double s = smoothStep(fy - i);
        const double t = smoothStep(fx - j);
        const double value = (1.0 - s) * ((1.0 - t) * knot(i, j) + t * knot(i, j + 1)) +
                             s * ((1.0 - t) * knot(i + 1, j) + t * knot(i + 1, j + 1));
        values_[static_cast<std::size_t>(y * kSize + x)] += static_cast<float>(weight * value);
      }
  }
  double sum = 0.0;
  double square = 0.0;
  for (const float value : values_) {
    sum += value;
    square += static_cast<double>(value) * value;
  }
  const double mean = sum / static_cast<double>(values_.size());
  const double deviation = std::sqrt(square / static_cast<double>(values_.size()) - mean * mean);
  for (float& value : values_) value = static_cast<float>((value - mean) / deviation);
}

float NoisePattern::at(double x, double y) const noexcept {
  const double fx = std::floor(x);
  const double fy = std::floor(y);
  const auto s = static_cast<float>(x - fx);
  const auto t = static_cast<float>(y - fy);
  constexpr unsigned kMask = kSize - 1;
  const unsigned x0 = static_cast<unsigned>(static_cast<long>(fx)) & kMask;
  const unsigned y0 = static_cast<unsigned>(static_cast<long>(fy)) & kMask;
  const unsigned x1 = (x0 + 1) & kMask;
  const unsigned y1 = (y0 + 1) & kMask;
  const float* const row0 = values_.data() + y0 * kSize;
  const float* const row1 = values_.data() + y1 * kSize;
  const float top = row0[x0] + s * (row0[x1] - row0[x0]);
  const float bottom = row1[x0] + s * (row1[x1] - row1[x0]);
  return top + t * (bottom - top);
}

const NoisePattern& coarsePattern() {
  static const NoisePattern pattern(16, 4, 1);
  return pattern;
}

const NoisePattern& finePattern() {
  static const NoisePattern pattern(256, 1, 2);
  return pattern;
}

}  // namespace raven_correction
