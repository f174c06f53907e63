// SPDX-License-Identifier: BSD-3-Clause
// Recordings of joints alone, commanded and observed, as of a robot whose kinematics nobody gave:
// the plant of session.h without kinematics and cameras. Joints q1 .. q6, q3 prismatic, home 0.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "plant/session.h"

namespace raven_correction::plant {

struct JointSessionOptions {
  int trajectories = 40;
  bool stops =
      false;  ///< one sample per 0.4 s at rest with one stamp for both streams, or a motion
  double noise = 5e-4;            ///< of revolute joints [rad]; prismatic ones a tenth of it in m
  double command_rate = 60;       ///< [Hz]
  double observation_rate = 100;  ///< [Hz]
  double start = 0.0;             ///< stamp of the first command [s]
  std::uint64_t seed = 1;
};

PlantSession recordJointsClean(const JointSessionOptions& options);
/// @throws InvalidInput  an effect that needs kinematics, or as applyEffect()
PlantSession recordJointsHidden(const JointSessionOptions& options,
                                const std::vector<HiddenEffect>& hidden);
/// Effects that joints alone can show: delay, lag, friction, speed limit, offset, gain, coupling,
/// backlash, eccentricity, creep.
const std::vector<std::string>& jointSessionEffects();
/// Size in multiples of the noise of the joint that moves most.
HiddenEffect drawJointsHidden(const JointSessionOptions& options, const std::string& effect,
                              std::uint64_t seed, double smallest, double largest);

}  // namespace raven_correction::plant
