// SPDX-License-Identifier: BSD-3-Clause
// A model that a pre-flight can judge: a rigid transform that promises half a millimetre and a
// third of a degree.
#pragma once

#include <string>

#include "raven_correction/correction/model.h"

namespace raven_correction {

/// @param rigid  what turns an observed pose into the command that produced it
/// @param delay  of motion capture behind commands [s]
inline Correction promisingModel(const std::string& id, const Pose& rigid, double delay) {
  Correction model;
  model.id = id;
  model.frame = "0_link";
  model.trained_at = 1000.0;
  model.delay = delay;
  model.rigid = rigid;
  model.motion.velocity = VelocityKind::kNone;
  model.trust.workspace_min.setConstant(-1.0);
  model.trust.workspace_max.setConstant(1.0);
  model.held_out.position_after = 0.0005;
  model.held_out.angle_after = 0.005;
  return model;
}

}  // namespace raven_correction
