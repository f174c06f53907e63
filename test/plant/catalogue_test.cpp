// SPDX-License-Identifier: BSD-3-Clause
// The catalogue's effect with the true parameters explains what the plant hides: signs, units and
// sizes of the map in hidden_effect.h are those of room `simulation`, which the plant itself does
// not use.
#include <gtest/gtest.h>

#include <cmath>

#include "plant/session.h"
#include "raven_correction/simulation/simulated_arm.h"
#include "simulation/simulations.h"

namespace raven_correction::plant {
namespace {

constexpr std::size_t kUnknownStart = 4;  // trajectories until every play has been through

/// The nominal simulation with this effect, its parameters by the names of the catalogue.
SimulationConfig simulationOf(const HiddenEffect& hidden) {
  SimulationConfig config = shippedSimulation("nominal");
  std::unique_ptr<Effect> effect = makeEffect(hidden.effect, config.robot);
  for (const auto& [symbol, value] : hidden.parameters) {
    EffectParameter named;
    named.symbol = symbol;
    if (!hidden.joints.empty()) named.joint = hidden.joints[0];
    if (hidden.joints.size() > 1) named.source = hidden.joints[1];
    const std::string label = parameterLabel(named, config.robot);
    effect->setValue(parameterIndex(*effect, label, config.robot), value);
  }
  config.set(std::move(effect));
  return config;
}

struct Distance {
  double squared_mm = 0.0;
  double squared_deg = 0.0;
  double count = 0.0;
  void add(const Pose& a, const Pose& b) {
    squared_mm += 1e6 * (a.p - b.p).squaredNorm();
    squared_deg += std::pow(57.29577951308232 * rotationAngle(a.q, b.q), 2);
    count += 1.0;
  }
  double multiples() const {
    return multiplesOfNoise({std::sqrt(squared_mm / count), std::sqrt(squared_deg / count)});
  }
};

/// How far the plant is from the simulation under the same commands, in multiples of the noise.
double distance(const Dataset& plant, const SimulationConfig& config) {
  const double start = plant.trajectories.front().commands.front().stamp;
  SimulatedArm arm(config, start);
  arm.reset(start, plant.trajectories.front().commands.front().pose);
  Distance distance;
  for (std::size_t i = 0; i < plant.trajectories.size(); ++i) {
    for (const StampedPose& command : plant.trajectories[i].commands) arm.command(command);
    for (const StampedPose& observed : plant.trajectories[i].observations) {
      arm.advanceTo(observed.stamp);
      if (i >= kUnknownStart) distance.add(observed.pose, arm.toolPose());
    }
  }
  return distance.multiples();
}

class PlantCatalogue : public testing::TestWithParam<std::string> {};

TEST_P(PlantCatalogue, EffectWithTheTrueParametersExplainsThePlant) {
  PlantOptions options;
  options.trajectories = 14;
  options.noise = 0.0;
  options.dirt = false;
  const HiddenEffect hidden = drawHidden(options, GetParam(), 21, 10.0, 20.0);
  const Dataset plant = recordHidden(options, {hidden}).noise_free;
  const double before = distance(plant, shippedSimulation("nominal"));
  const double after = distance(plant, simulationOf(hidden));
  EXPECT_LT(after, 0.06 * before) << describe(hidden) << ", from " << before << " to " << after;
  RecordProperty("share_left_percent", static_cast<int>(std::lround(100.0 * after / before)));
}

INSTANTIATE_TEST_SUITE_P(AllEffects, PlantCatalogue, testing::ValuesIn(hiddenEffects()),
                         [](const testing::TestParamInfo<std::string>& effect) {
                           return effect.param;
                         });

}  // namespace
}  // namespace raven_correction::plant
