// SPDX-License-Identifier: BSD-3-Clause
// What the tests of the diagnosis begin with: the ideal robot, and names of parametrised tests.
// Comparing a verdict with the truth is judge.h.
#pragma once

#include <gtest/gtest.h>

#include <string>

#include "raven_correction/simulation/simulation_config.h"

namespace raven_correction {

inline const SimulationConfig& nominal() {
  static const SimulationConfig config = loadSimulationConfig("config/simulation/nominal.yaml");
  return config;
}

inline std::string effectName(const testing::TestParamInfo<const char*>& info) {
  return info.param;
}

}  // namespace raven_correction
