// SPDX-License-Identifier: BSD-3-Clause
// The list of effects and its flat vector of parameters. Reading and writing the YAML file is
// simulation_file.cpp.
#include "raven_correction/simulation/simulation_config.h"

#include <algorithm>

#include "raven_correction/error.h"
#include "raven_correction/simulation/effect_registry.h"

namespace raven_correction {

const Effect* SimulationConfig::find(const std::string& effect_name) const noexcept {
  for (const auto& effect : effects)
    if (effect_name == effect->name()) return effect.get();
  return nullptr;
}

void SimulationConfig::set(std::unique_ptr<Effect> effect) {
  remove(effect->name());
  const int rank = effectRank(effect->name());
  const auto place = std::find_if(effects.begin(), effects.end(), [&](const auto& other) {
    return effectRank(other->name()) > rank;
  });
  effects.insert(place, std::shared_ptr<const Effect>(std::move(effect)));
}

void SimulationConfig::remove(const std::string& effect_name) {
  effects.erase(std::remove_if(effects.begin(), effects.end(),
                               [&](const auto& effect) { return effect_name == effect->name(); }),
                effects.end());
}

std::vector<std::string> parameterLabels(const SimulationConfig& config) {
  std::vector<std::string> labels;
  for (const auto& effect : config.effects)
    for (const EffectParameter& parameter : effect->parameters())
      labels.push_back(std::string(effect->name()) + "." + parameterLabel(parameter, config.robot));
  return labels;
}

std::vector<EffectParameter> parameterList(const SimulationConfig& config) {
  std::vector<EffectParameter> all;
  for (const auto& effect : config.effects)
    all.insert(all.end(), effect->parameters().begin(), effect->parameters().end());
  return all;
}

Eigen::VectorXd parameterVector(const SimulationConfig& config) {
  const std::vector<EffectParameter> all = parameterList(config);
  Eigen::VectorXd values(static_cast<Eigen::Index>(all.size()));
  for (std::size_t i = 0; i < all.size(); ++i) values(static_cast<Eigen::Index>(i)) = all[i].value;
  return values;
}

SimulationConfig withParameters(const SimulationConfig& config, const Eigen::VectorXd& values) {
  const Eigen::Index expected = parameterVector(config).size();
  if (values.size() != expected)
    throw InvalidInput(format("%d values for the %d effect parameters of simulation %s",
                              static_cast<int>(values.size()), static_cast<int>(expected),
                              config.name.c_str()));
  SimulationConfig result = config;
  Eigen::Index next = 0;
  for (auto& effect : result.effects) {
    std::unique_ptr<Effect> changed = effect->clone();
    const int count = static_cast<int>(changed->parameters().size());
    for (int i = 0; i < count; ++i) changed->setValue(i, values(next++));
    effect = std::move(changed);
  }
  return result;
}

}  // namespace raven_correction
