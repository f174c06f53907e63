// SPDX-License-Identifier: BSD-3-Clause
// The covariance functions one distance at a time, and their names.
#include "raven_correction/regression/kernel.h"

#include <cmath>

#include "raven_correction/error.h"

namespace raven_correction {

double correlation(KernelType type, double r) noexcept {
  switch (type) {
    case KernelType::kSquaredExponential:
      return std::exp(-0.5 * r * r);
    case KernelType::kMatern32: {
      const double t = std::sqrt(3.0) * r;
      return (1.0 + t) * std::exp(-t);
    }
    case KernelType::kMatern52: {
      const double t = std::sqrt(5.0) * r;
      return (1.0 + t + t * t / 3.0) * std::exp(-t);
    }
  }
  return 0.0;
}

double correlationSlope(KernelType type, double r) noexcept {
  switch (type) {
    case KernelType::kSquaredExponential:
      return std::exp(-0.5 * r * r);
    case KernelType::kMatern32:
      return 3.0 * std::exp(-std::sqrt(3.0) * r);
    case KernelType::kMatern52: {
      const double t = std::sqrt(5.0) * r;
      return 5.0 / 3.0 * (1.0 + t) * std::exp(-t);
    }
  }
  return 0.0;
}

KernelType kernelFromName(const std::string& name) {
  for (const KernelType type :
       {KernelType::kSquaredExponential, KernelType::kMatern32, KernelType::kMatern52}) {
    if (name == kernelName(type)) return type;
  }
  throw InvalidInput(format("kernel '%s' is unknown; use squared_exponential, matern32 or matern52",
                            name.c_str()));
}

const char* kernelName(KernelType type) noexcept {
  switch (type) {
    case KernelType::kSquaredExponential:
      return "squared_exponential";
    case KernelType::kMatern32:
      return "matern32";
    case KernelType::kMatern52:
      return "matern52";
  }
  return "unknown";
}

}  // namespace raven_correction
