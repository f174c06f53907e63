// SPDX-License-Identifier: BSD-3-Clause
// The jaw of a simulated gripper and what it holds; a tool pose says nothing of either. How two
// finger joints make an opening is robot/fingers.h, what a held mass does is gravity_load.h.
#pragma once

#include <vector>

namespace raven_correction {

struct GripperConfig {
  double lower = -0.5236;  ///< smallest and largest opening that can be commanded [rad]
  double upper = 1.5708;
  double speed = 4.0;          ///< of the opening [rad/s]
  double grasp_opening = 0.2;  ///< a jaw that closes past it holds something [rad]
  double payload = 5e-4;       ///< mass of what it holds then: a piece of foam [kg]
};

/// Every scalar of the configuration with its key in YAML and its range.
struct GripperField {
  const char* key;
  double GripperConfig::*value;
  double lower;
  double upper;
};
const std::vector<GripperField>& gripperFields();
/// @throws InvalidInput  a value outside its range, or lower > upper
void checkGripper(const GripperConfig& config);

struct GripperState {
  double opening = 0.0;  ///< [rad]
  double target = 0.0;   ///< opening that was commanded last [rad]
  double payload = 0.0;  ///< mass that is held [kg]
};

/// One step: the opening a moves towards its target at constant speed, which is exact for any step.
///
///   a <- a + clamp(target - a, -speed step, speed step)
///
/// A jaw that closes past grasp_opening picks up `payload`, wherever it is; one that opens past it
/// lets go. A jaw that was never open holds nothing.
/// @param step  > 0 [s]
void advanceGripper(const GripperConfig& config, double step, GripperState& state) noexcept;

}  // namespace raven_correction
