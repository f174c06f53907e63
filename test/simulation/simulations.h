// SPDX-License-Identifier: BSD-3-Clause
// Simulations for tests: the shipped ones, and the nominal one with one effect.
#pragma once

#include <initializer_list>
#include <memory>
#include <string>
#include <utility>

#include "raven_correction/simulation/effect_registry.h"
#include "raven_correction/simulation/simulation_config.h"

namespace raven_correction {

inline SimulationConfig shippedSimulation(const std::string& name) {
  return loadSimulationConfig("config/simulation/" + name + ".yaml");
}

/// The parameter with this label ("w[elbow]") of an effect.
inline int parameterIndex(const Effect& effect, const std::string& label,
                          const KinematicChain& robot) {
  for (std::size_t i = 0; i < effect.parameters().size(); ++i)
    if (parameterLabel(effect.parameters()[i], robot) == label) return static_cast<int>(i);
  return -1;
}

/// An effect with some parameters set by label.
inline std::unique_ptr<Effect> effectWith(
    const std::string& name, const KinematicChain& robot,
    std::initializer_list<std::pair<const char*, double>> values) {
  std::unique_ptr<Effect> effect = makeEffect(name, robot);
  for (const auto& [label, value] : values)
    effect->setValue(parameterIndex(*effect, label, robot), value);
  return effect;
}

/// The nominal simulation with one effect added.
inline SimulationConfig simulationWith(
    const std::string& name, std::initializer_list<std::pair<const char*, double>> values) {
  SimulationConfig config = shippedSimulation("nominal");
  config.set(effectWith(name, config.robot, values));
  return config;
}

}  // namespace raven_correction
