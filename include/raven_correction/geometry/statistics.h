// SPDX-License-Identifier: BSD-3-Clause
// Order statistics and moments of plain lists of numbers, in the units of the numbers.
#pragma once

#include <vector>

namespace raven_correction {

/// @param q  in [0, 1]; linear between order statistics (0 = smallest, 1 = largest)
/// @throws InvalidInput  for an empty list
double quantile(std::vector<double> values, double q);
/// quantile(values, 0.5)
double median(std::vector<double> values);
double mean(const std::vector<double>& values);               ///< 0 for an empty list
double standardDeviation(const std::vector<double>& values);  ///< n - 1 in the divisor; 0 if n < 2

}  // namespace raven_correction
