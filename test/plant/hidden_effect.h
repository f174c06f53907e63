// SPDX-License-Identifier: BSD-3-Clause
// The map from the catalogue of effects to the plant's physics: which constant of joint_drive.h and
// robot_plant.h hides which effect, and by how much. Causes that no effect describes are in
// outside.h.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "plant/robot_plant.h"

namespace raven_correction::plant {

/// One hidden cause: the truth that a diagnosis has to name.
struct HiddenEffect {
  std::string effect;       ///< name in the catalogue
  std::vector<int> joints;  ///< row of the chain; for a coupling the moved one, then the source
  std::map<std::string, double> parameters;  ///< symbols and units of the catalogue
  /// How far it moves what is observed: rms over the session against the same session without it,
  /// no noise, measured by running the plant twice. For joint sessions the largest of the joints.
  double size_mm = 0.0;
  double size_deg = 0.0;
};

/// "backlash[elbow] w=0.02 (1.3 mm, 0.4 deg)", for messages of tests.
std::string describe(const HiddenEffect& effect);

/// Names of all effects that applyEffect() knows, in the order of the catalogue.
const std::vector<std::string>& hiddenEffects();
/// Effects of a single joint, without joint_coupling.
bool isJointEffect(const std::string& effect);

/// Builds the physics that has this effect:
///
///   command_delay       tau              queue of set-points: they act tau after their stamp
///   tracking_lag        T                overdamped loop: k_d + b = T k_p; second pole k_d / J_m
///   drive_friction      w                Coulomb friction of the motor: F_c = w k_p / 2
///   speed_limit         v                speed of the motor without load: v_0 = v (stall force
///   high) joint_offset        d                homing error: the encoder's zero is d away
///   joint_gain          g                radii of the pulleys: ratio 1 + g, held at home
///   joint_coupling      c                cable of i runs over the pulley of j: radius c (q_j -
///   home) backlash            w                dead zone of full width w in the cable; the link
///   stays
///                                        where its friction, twice its load, holds it
///   cable_stretch       s                k_c = 1 / s, light and little damped enough to be
///                                        quasi-static within 10 ms
///   pulley_eccentricity A, N, phi        radius of the pulley 1 + A N cos(N m + phi)
///   creep               a, T             Kelvin-Voigt element under the pretension F_0: a = F_0 /
///   k_1,
///                                        T = c_1 / k_1, from the start of the session
///   link_geometry       alpha, a, d      one of the three, of the real chain
///   base_registration   x .. rz          where the base really is
///   tool_offset         x .. rz          where the markers really are
///   registration_shift  t0, x .. rz      everything is seen displaced after t0
///   mocap_scale         s                lengths that the cameras measure are 1 + s as long
///
/// A second form of backlash, hysteresis of Bouc-Wen instead of a dead zone, has the parameter `n`
/// beside `w`: its sharpness (8 is nearly a play).
/// @throws InvalidInput  unknown effect, joint or symbol, or a value that is not finite
void applyEffect(const HiddenEffect& effect, RobotPhysics& physics);

/// The same cause made larger or smaller: amplitudes times `factor`; numbers that say where or when
/// (N, phi, t0, creep's T) stay; a speed limit is divided by it.
HiddenEffect scaled(const HiddenEffect& effect, double factor);

/// The effect with amplitudes no larger than a robot would have that still works: lag and delay
/// 0.3 s, play and friction 0.25 rad or 1 cm, gain and coupling of equals 0.3, offsets and creep
/// 0.3 rad or 2 cm, eccentricity 0.1 rad or 5 mm.
HiddenEffect plausible(const HiddenEffect& effect, const KinematicChain& robot);

}  // namespace raven_correction::plant
