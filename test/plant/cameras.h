// SPDX-License-Identifier: BSD-3-Clause
// What a small motion-capture system makes of perfect poses: noise, jitter, repeated frames, gaps,
// jumps while a camera is blind, grossly wrong orientations. It never looks at how they came about.
#pragma once

#include <cstdint>

#include "raven_correction/geometry/stream.h"

namespace raven_correction::plant {

struct CameraOptions {
  double noise = 1e-4;                ///< of positions, standard deviation per axis [m]
  double orientation_noise = 5.2e-3;  ///< of rotation vectors, per axis [rad]: 0.3 deg
  // dirt
  double stamp_jitter = 1e-4;        ///< standard deviation of a stamp's error [s]
  double repeat_probability = 0.09;  ///< a frame is the one before again, with its stamp [-]
  double gap_rate = 0.4;             ///< how often nothing is seen [1/s]
  double gap_time = 0.1;             ///< for how long, mean [s]
  double jump_rate = 0.1;            ///< how often a camera is blind and positions jump [1/s]
  double jump_time = 0.3;            ///< for how long, mean [s]
  double jump_size = 2e-3;           ///< of the jump, standard deviation per axis [m]
  double flip_rate = 0.04;           ///< how often the orientation is grossly wrong [1/s]
  double flip_time = 0.15;           ///< for how long, mean [s]
};
/// The same without dirt: noise only.
CameraOptions cleanCameras(double noise, double orientation_noise);

/// @param perfect  poses at the exposures, stamps strictly increasing
/// @return what is recorded; stamps never decrease
PoseStream photograph(const PoseStream& perfect, const CameraOptions& options, std::uint64_t seed);

}  // namespace raven_correction::plant
