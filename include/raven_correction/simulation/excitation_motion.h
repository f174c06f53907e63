// SPDX-License-Identifier: BSD-3-Clause
// Motions made for identification: every joint alone, in both directions, at several speeds, with
// rests between. debridement_motion.h makes the motions of the task, where joints move together.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "raven_correction/geometry/stream.h"
#include "raven_correction/simulation/debridement_motion.h"

namespace raven_correction {

struct ExcitationConfig {
  double amplitude = 0.12;  ///< of a stroke, as a share of the joint's range [-], in (0, 0.4]
  /// Duration of a stroke by one amplitude, one round per value [s], each > 0.
  std::vector<double> stroke_times{0.6, 1.2, 2.4};
  double pause = 0.6;  ///< at rest after every stroke [s], >= 0
};

struct ExcitationTrajectory {
  std::string label;    ///< joint and stroke time, "elbow_1.2s", or "approach"
  PoseStream commands;  ///< nominal tool poses of the joint motion, in `base`
};

/// From a posture over the debridement field, for each stroke time and each joint: up by one
/// amplitude, down by two, up by two and down by one, resting after each stroke; so each direction
/// is approached from either side. An approach to a new random posture precedes each joint.
/// Strokes are shortened where a joint limit is near; they may leave the debridement command box.
/// @param start  stamp of the first command [s]
/// @throws InvalidInput  a value out of range, or a field that the robot cannot reach
std::vector<ExcitationTrajectory> excitationMotions(const ExcitationConfig& config,
                                                    const DebridementConfig& field,
                                                    const KinematicChain& robot, double start,
                                                    std::uint64_t seed);

}  // namespace raven_correction
