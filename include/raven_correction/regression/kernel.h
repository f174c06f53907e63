// SPDX-License-Identifier: BSD-3-Clause
// Stationary covariance functions of a scaled distance. How they are evaluated fast on whole
// matrices is kernel_matrix.h; how their parameters are learnt is hyperparameters.h.
#pragma once

#include <string>

namespace raven_correction {

/// Correlation c(r) of the scaled distance r = || (a - b) / l || (l: one length per feature, or
/// one for all). k(a, b) = s^2 c(r). Source: Rasmussen, Williams 2006, Gaussian Processes for
/// Machine Learning, section 4.2, isbn 026218253X.
enum class KernelType {
  kSquaredExponential,  ///< exp(-r^2 / 2)
  kMatern32,            ///< (1 + sqrt(3) r) exp(-sqrt(3) r)
  kMatern52,            ///< (1 + sqrt(5) r + 5 r^2 / 3) exp(-sqrt(5) r)
};

/// c(r) for one distance r >= 0 [-]. The reference that the vectorised code is tested against.
double correlation(KernelType type, double r) noexcept;

/// g(r) = -c'(r) / r, finite at r = 0 [-]. With it the derivative by one log length scale is
///   d c / d log l_j = g(r) (a_j - b_j)^2 / l_j^2
double correlationSlope(KernelType type, double r) noexcept;

/// "squared_exponential", "matern32", "matern52".
/// @throws InvalidInput  for any other name; the text lists these
KernelType kernelFromName(const std::string& name);
const char* kernelName(KernelType type) noexcept;

}  // namespace raven_correction
