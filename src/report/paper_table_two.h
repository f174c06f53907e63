// SPDX-License-Identifier: BSD-3-Clause
// Table II of the paper, to be put beside ours.
#pragma once

#include <string>

namespace raven_correction {

/// Mahler et al. 2014, Table II: mean absolute error and standard deviation of tx, ty, tz [mm].
struct PaperCondition {
  const char* name;
  double mean_abs[3];
  double std[3];
};
constexpr PaperCondition kPaperTableTwo[] = {{"none", {20.3, 13.0, 22.8}, {0.8, 2.5, 2.9}},
                                             {"full", {1.5, 4.9, 2.4}, {1.1, 1.5, 1.4}},
                                             {"endpoint", {2.0, 3.0, 1.0}, {0.9, 1.0, 0.7}}};

/// Null for a condition that the paper does not have.
inline const PaperCondition* paperConditionOf(const std::string& name) {
  for (const PaperCondition& condition : kPaperTableTwo)
    if (name == condition.name) return &condition;
  return nullptr;
}

}  // namespace raven_correction
