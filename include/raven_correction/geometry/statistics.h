// SPDX-License-Identifier: BSD-3-Clause
// Order statistics and moments of plain lists of numbers, in the units of the numbers, and how far
// they would change with other motions (bootstrap).
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

namespace raven_correction {

/// @param q  in [0, 1]; linear between order statistics (0 = smallest, 1 = largest)
/// @throws InvalidInput  for an empty list
double quantile(std::vector<double> values, double q);
/// quantile(values, 0.5)
double median(std::vector<double> values);
double mean(const std::vector<double>& values);               ///< 0 for an empty list
double standardDeviation(const std::vector<double>& values);  ///< n - 1 in the divisor; 0 if n < 2

/// Bootstrap over groups, so that samples of one motion stay together: calls `visit` `resamples`
/// times with `groups` indices in [0, groups), drawn with replacement. The same draws for the same
/// seed. Without groups nothing is called.
/// Source: Efron 1979, doi:10.1214/aos/1176344552
void bootstrapOverGroups(std::size_t groups, int resamples, std::uint64_t seed,
                         const std::function<void(const std::vector<std::size_t>& drawn)>& visit);

/// 2.5 % and 97.5 % quantile of what resamples come to.
struct Interval {
  double lower = 0.0, upper = 0.0;
};
/// @throws InvalidInput  for an empty list
Interval interval95(const std::vector<double>& resampled);

}  // namespace raven_correction
