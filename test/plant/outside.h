// SPDX-License-Identifier: BSD-3-Clause
// Causes that no effect of the catalogue describes: a diagnosis shall say that structure remains
// and blame nothing else for it. The catalogue's effects are in hidden_effect.h.
#pragma once

#include <string>
#include <vector>

#include "plant/robot_plant.h"

namespace raven_correction::plant {

/// The first three are near an effect of the catalogue, which can explain a good part of them.
enum class OutsideKind {
  kBoucWen,           ///< hysteresis of a cable with strong rounding (n = 1): not far from backlash
  kPositionFriction,  ///< friction of a motor that changes along its travel, from nothing to twice
  kQuadraticJoint,  ///< q = u + c (u - middle)^2: half a period of a pulley_eccentricity is like it
  kResonance,       ///< a joint rings at a few hertz after every start and stop
  kProductCoupling,  ///< two joints away from their middles pull the cable of a third: c q_a q_b
  kThermalCycle,     ///< the shaft's length goes up and down with time
  kBentShaft,   ///< the shaft is bent in waves: lateral error along the insertion, turning with
                ///< the roll
  kRollWobble,  ///< lateral error eight times per turn of the roll
  kVolumeDistortion,  ///< quadratic field of the mocap volume, no scale
  kTableSway,         ///< the whole robot moves to and fro at 1.3 Hz
};
const std::vector<OutsideKind>& outsideKinds();
/// "bouc_wen", "position_friction", ...
const char* toString(OutsideKind kind) noexcept;
/// An effect of the catalogue can explain a good part of it.
bool isNearCatalogue(OutsideKind kind) noexcept;
/// The kind acts on one joint, so a joint is to be chosen.
bool isJointKind(OutsideKind kind) noexcept;

/// @param joint      row of the chain; ignored where isJointKind() is false
/// @param amplitude  1 is about a millimetre at a Raven's tool; larger is more
/// @param span       how far each joint moves in the session [rad or m]
/// @param middle     of that motion [rad or m]
void applyOutside(OutsideKind kind, int joint, double amplitude, const JointVector& span,
                  const JointVector& middle, RobotPhysics& physics);

}  // namespace raven_correction::plant
