// SPDX-License-Identifier: BSD-3-Clause
#include "plant/outside.h"

#include <cmath>

namespace raven_correction::plant {
namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr double kRingFrequency = 3.5;  // at amplitude 1 [Hz]
constexpr double kRingDamping = 0.06;   // share of critical

/// A soft cable with little damping, without the load that would stretch it.
void letRing(double frequency, JointPhysics& joint) {
  const double rate = 2.0 * kPi * frequency;
  joint.link_inertia = 0.05 * (joint.stiffness > 1e6 ? 20.0 : 1.0);
  joint.cable_stiffness = joint.link_inertia * rate * rate;
  joint.cable_damping = 2.0 * kRingDamping * rate * joint.link_inertia;
  joint.joint_viscous = 0.0;
  joint.joint_friction = 0.0;
  joint.load_share = 0.0;
}

}  // namespace

const std::vector<OutsideKind>& outsideKinds() {
  static const std::vector<OutsideKind> kinds{
      OutsideKind::kBoucWen,      OutsideKind::kPositionFriction, OutsideKind::kResonance,
      OutsideKind::kThermalCycle, OutsideKind::kQuadraticJoint,   OutsideKind::kBentShaft,
      OutsideKind::kRollWobble,   OutsideKind::kVolumeDistortion, OutsideKind::kTableSway};
  return kinds;
}

const char* toString(OutsideKind kind) noexcept {
  switch (kind) {
    case OutsideKind::kBoucWen:
      return "bouc_wen";
    case OutsideKind::kPositionFriction:
      return "position_friction";
    case OutsideKind::kResonance:
      return "resonance";
    case OutsideKind::kThermalCycle:
      return "thermal_cycle";
    case OutsideKind::kQuadraticJoint:
      return "quadratic_joint";
    case OutsideKind::kBentShaft:
      return "bent_shaft";
    case OutsideKind::kRollWobble:
      return "roll_wobble";
    case OutsideKind::kVolumeDistortion:
      return "volume_distortion";
    case OutsideKind::kTableSway:
      break;
  }
  return "table_sway";
}

bool isJointKind(OutsideKind kind) noexcept {
  return kind == OutsideKind::kBoucWen || kind == OutsideKind::kPositionFriction ||
         kind == OutsideKind::kResonance || kind == OutsideKind::kQuadraticJoint;
}

void applyOutside(OutsideKind kind, int joint, double amplitude, double span, double middle,
                  RobotPhysics& physics) {
  JointPhysics& drive = physics.joints[static_cast<std::size_t>(joint)];
  const double error = 0.02 * amplitude * span;
  switch (kind) {
    case OutsideKind::kBoucWen:
      drive.hysteresis_width = 4.0 * error;
      drive.hysteresis_sharpness = 1.0;
      break;
    case OutsideKind::kPositionFriction:
      drive.motor_friction = error * drive.stiffness;
      drive.friction_waviness = 1.0;
      drive.friction_wave_number = 4.0 * kPi / span;
      break;
    case OutsideKind::kResonance:
      letRing(kRingFrequency / std::sqrt(amplitude), drive);
      break;
    case OutsideKind::kThermalCycle:
      physics.outside.thermal_amplitude = 1e-3 * amplitude;
      break;
    case OutsideKind::kQuadraticJoint:
      drive.curvature = 8.0 * error / (span * span);
      drive.middle = middle;
      break;
    case OutsideKind::kBentShaft:
      physics.outside.shaft_curvature = 0.2 * amplitude;
      break;
    case OutsideKind::kRollWobble:
      physics.outside.wobble = 1e-3 * amplitude;
      break;
    case OutsideKind::kVolumeDistortion:
      physics.outside.distortion = 1e-3 * amplitude;
      break;
    case OutsideKind::kTableSway:
      physics.outside.sway = 1e-3 * amplitude;
      break;
  }
}

}  // namespace raven_correction::plant
