// SPDX-License-Identifier: BSD-3-Clause
// The catalogue of effects. Adding one: write src/simulation/effect_NAME.cpp, and add a line to
// the table in effect_registry.cpp. The order of the table is the order of effects within a stage.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "raven_correction/simulation/effect.h"

namespace raven_correction {

/// Names of all effects, in the order in which they act.
const std::vector<std::string>& effectNames();
/// Place of the effect in effectNames(), or -1.
int effectRank(const std::string& name) noexcept;
/// An effect for this robot with all parameters at their nominal values.
/// @throws InvalidInput  unknown name; the text lists those there are
std::unique_ptr<Effect> makeEffect(const std::string& name, const KinematicChain& robot);

}  // namespace raven_correction
