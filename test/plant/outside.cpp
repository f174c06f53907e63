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

/// The next two joints pull joint `moved`, the more the further both are from their middles.
ProductCoupling productOf(int moved, double error, const JointVector& span,
                          const JointVector& middle) {
  const int n = static_cast<int>(span.size());
  ProductCoupling product;
  product.moved = moved;
  product.a = (moved + 1) % n;
  product.b = (moved + 2) % n;
  product.c = 8.0 * error / (span(product.a) * span(product.b));
  product.middle_a = middle(product.a);
  product.middle_b = middle(product.b);
  return product;
}

}  // namespace

const std::vector<OutsideKind>& outsideKinds() {
  static const std::vector<OutsideKind> kinds{
      OutsideKind::kBoucWen,   OutsideKind::kPositionFriction, OutsideKind::kQuadraticJoint,
      OutsideKind::kResonance, OutsideKind::kProductCoupling,  OutsideKind::kThermalCycle,
      OutsideKind::kBentShaft, OutsideKind::kRollWobble,       OutsideKind::kVolumeDistortion,
      OutsideKind::kTableSway};
  return kinds;
}

const char* toString(OutsideKind kind) noexcept {
  switch (kind) {
    case OutsideKind::kBoucWen:
      return "bouc_wen";
    case OutsideKind::kPositionFriction:
      return "position_friction";
    case OutsideKind::kQuadraticJoint:
      return "quadratic_joint";
    case OutsideKind::kResonance:
      return "resonance";
    case OutsideKind::kProductCoupling:
      return "product_coupling";
    case OutsideKind::kThermalCycle:
      return "thermal_cycle";
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

bool isNearCatalogue(OutsideKind kind) noexcept {
  return kind == OutsideKind::kBoucWen || kind == OutsideKind::kPositionFriction ||
         kind == OutsideKind::kQuadraticJoint;
}

bool isJointKind(OutsideKind kind) noexcept {
  return isNearCatalogue(kind) || kind == OutsideKind::kResonance ||
         kind == OutsideKind::kProductCoupling;
}

void applyOutside(OutsideKind kind, int joint, double amplitude, const JointVector& span,
                  const JointVector& middle, RobotPhysics& physics) {
  JointPhysics& drive = physics.joints[static_cast<std::size_t>(joint)];
  const double travel = span(joint);
  const double error = 0.02 * amplitude * travel;
  switch (kind) {
    case OutsideKind::kBoucWen:
      drive.hysteresis_width = 4.0 * error;
      drive.hysteresis_sharpness = 1.0;
      break;
    case OutsideKind::kPositionFriction:
      drive.motor_friction = error * drive.stiffness;
      drive.friction_waviness = 1.0;
      drive.friction_wave_number = 4.0 * kPi / travel;
      break;
    case OutsideKind::kQuadraticJoint:
      drive.curvature = 8.0 * error / (travel * travel);
      drive.middle = middle(joint);
      break;
    case OutsideKind::kResonance:
      letRing(kRingFrequency / std::sqrt(amplitude), drive);
      break;
    case OutsideKind::kProductCoupling:
      physics.product = productOf(joint, error, span, middle);
      break;
    case OutsideKind::kThermalCycle:
      physics.outside.thermal_amplitude = 1e-3 * amplitude;
      break;
    case OutsideKind::kBentShaft:
      physics.outside.shaft_wave = 1e-3 * amplitude;
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
