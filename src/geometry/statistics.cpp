// SPDX-License-Identifier: BSD-3-Clause
#include "raven_correction/geometry/statistics.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>

#include "raven_correction/error.h"

namespace raven_correction {

double quantile(std::vector<double> values, double q) {
  if (values.empty()) throw InvalidInput("a quantile of no values is not defined");
  const double rank = std::clamp(q, 0.0, 1.0) * static_cast<double>(values.size() - 1);
  const auto below = values.begin() + static_cast<std::ptrdiff_t>(rank);
  std::nth_element(values.begin(), below, values.end());
  const double low = *below;
  if (below + 1 == values.end()) return low;
  const double high = *std::min_element(below + 1, values.end());
  return low + (rank - std::floor(rank)) * (high - low);
}

double median(std::vector<double> values) { return quantile(std::move(values), 0.5); }

double mean(const std::vector<double>& values) {
  if (values.empty()) return 0.0;
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

double standardDeviation(const std::vector<double>& values) {
  if (values.size() < 2) return 0.0;
  const double centre = mean(values);
  double sum = 0.0;
  for (const double value : values) sum += (value - centre) * (value - centre);
  return std::sqrt(sum / static_cast<double>(values.size() - 1));
}

void bootstrapOverGroups(std::size_t groups, int resamples, std::uint64_t seed,
                         const std::function<void(const std::vector<std::size_t>& drawn)>& visit) {
  if (groups == 0) return;
  std::mt19937_64 engine(seed);
  std::uniform_int_distribution<std::size_t> draw(0, groups - 1);
  std::vector<std::size_t> drawn(groups);
  for (int i = 0; i < resamples; ++i) {
    for (std::size_t& group : drawn) group = draw(engine);
    visit(drawn);
  }
}

Interval interval95(const std::vector<double>& resampled) {
  return {quantile(resampled, 0.025), quantile(resampled, 0.975)};
}

}  // namespace raven_correction
