// SPDX-License-Identifier: BSD-3-Clause
// The shipped robots, and random joints inside their limits, for tests.
#pragma once

#include <random>
#include <string>

#include "raven_correction/robot/chain_file.h"

namespace raven_correction {

inline const std::vector<std::string>& shippedRobots() {
  static const std::vector<std::string> names{"raven2_left", "raven2_right", "raven2_gold",
                                              "raven2_green", "psm"};
  return names;
}

inline KinematicChain shippedRobot(const std::string& name) {
  return loadKinematicChain("config/robots/" + name + ".yaml");
}

inline JointVector randomJoints(const KinematicChain& chain, std::mt19937_64& random,
                                double margin = 0.0) {
  std::uniform_real_distribution<double> share(margin, 1.0 - margin);
  JointVector q(chain.size());
  for (int i = 0; i < chain.size(); ++i)
    q(i) = chain.lower()(i) + share(random) * (chain.upper()(i) - chain.lower()(i));
  return q;
}

}  // namespace raven_correction
