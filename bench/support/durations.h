// SPDX-License-Identifier: BSD-3-Clause
// Percentiles of durations for benchmarks, and what the machine itself takes from a program that
// does nothing: no percentile can be better than that.
#pragma once

#include <algorithm>
#include <chrono>
#include <cmath>
#include <nlohmann/json.hpp>
#include <vector>

namespace raven_correction {
namespace bench {

/// The smallest value that at least this share of all do not exceed; 0 without any.
inline double percentile(const std::vector<double>& sorted, double share) {
  if (sorted.empty()) return 0.0;
  const double rank = std::ceil(share * static_cast<double>(sorted.size()));
  return sorted[static_cast<std::size_t>(std::max(rank, 1.0)) - 1];
}

/// {"p50_us", "p99_us", "p999_us", "max_us"}. @param values  [us]
inline nlohmann::json percentiles(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  const auto at = [&](double share) { return std::round(10.0 * percentile(values, share)) / 10.0; };
  return {{"p50_us", at(0.5)}, {"p99_us", at(0.99)}, {"p999_us", at(0.999)}, {"max_us", at(1.0)}};
}

/// A loop looks at the clock for a second; where it is kept from doing so, that is an interruption.
/// @return {"per_second", "p50_us", "p99_us", "p999_us", "max_us"} of those above 10 us
inline nlohmann::json interruptions() {
  using Clock = std::chrono::steady_clock;
  using Microseconds = std::chrono::duration<double, std::micro>;
  constexpr double kShortest = 10.0;
  std::vector<double> gaps;
  const auto start = Clock::now();
  auto last = start;
  while (last - start < std::chrono::seconds(1)) {
    const auto now = Clock::now();
    const double gap = Microseconds(now - last).count();
    if (gap > kShortest) gaps.push_back(gap);
    last = now;
  }
  const auto count = gaps.size();
  nlohmann::json result = percentiles(std::move(gaps));
  result["per_second"] = count;
  return result;
}

}  // namespace bench
}  // namespace raven_correction
