// SPDX-License-Identifier: BSD-3-Clause
#include "raven_correction/simulation/gripper.h"

#include <algorithm>

#include "raven_correction/error.h"

namespace raven_correction {

const std::vector<GripperField>& gripperFields() {
  using C = GripperConfig;
  static const std::vector<GripperField> fields{{"lower", &C::lower, -1.6, 3.2},
                                                {"upper", &C::upper, -1.6, 3.2},
                                                {"speed", &C::speed, 0.01, 100.0},
                                                {"grasp_opening", &C::grasp_opening, -1.6, 3.2},
                                                {"payload", &C::payload, 0.0, 1.0}};
  return fields;
}

void checkGripper(const GripperConfig& config) {
  for (const GripperField& field : gripperFields()) {
    const double value = config.*field.value;
    if (!(value >= field.lower && value <= field.upper))
      throw InvalidInput(format("gripper: %s = %g is outside [%g, %g]", field.key, value,
                                field.lower, field.upper));
  }
  if (config.lower > config.upper)
    throw InvalidInput(
        format("gripper: lower = %g is above upper = %g", config.lower, config.upper));
}

void advanceGripper(const GripperConfig& config, double step, GripperState& state) noexcept {
  if (state.opening == state.target) return;
  const bool was_open = state.opening >= config.grasp_opening;
  const double reach = config.speed * step;
  state.opening += std::clamp(state.target - state.opening, -reach, reach);
  const bool is_open = state.opening >= config.grasp_opening;
  if (was_open != is_open) state.payload = is_open ? 0.0 : config.payload;
}

}  // namespace raven_correction
