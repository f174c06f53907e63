// SPDX-License-Identifier: BSD-3-Clause
// Instants of a recording at which the tool or the links were seen, each with the simulated joints
// and their speed, and the blocks of the residual that belong to it. The residual itself is
// residual.h; instants of encoders alone are left out.
#pragma once

#include <vector>

#include "raven_correction/diagnosis/residual.h"

namespace raven_correction {

struct ObservedSample {
  int motion = 0;
  double stamp = 0.0;      ///< [s]
  Eigen::VectorXd joints;  ///< simulated [rad or m]
  /// From the sample before to the one after, in motion [rad/s or m/s]. Beyond 1.5 times what 99 %
  /// of the samples keep it is a step of the set-points between two frames, and brought to that.
  Eigen::VectorXd speed;
  std::vector<std::size_t> blocks;  ///< of layout.blocks, in the order of the channels
};

/// @param joints  as residuals() returns them: one column per block
std::vector<ObservedSample> observedSamples(const Recording& recording,
                                            const ResidualLayout& layout,
                                            const Eigen::MatrixXd& joints);

/// How the simulated components of a sample change: velocity of the nominal tool in base, and its
/// angular velocity in the frame of the tool that the residual is of [m/s, rad/s]; joint data: the
/// joint speeds.
/// @param simulated  of the simulation that left the residual
Eigen::VectorXd simulatedVelocity(const Recording& recording, const ObservedSample& sample,
                                  const SimulatedSamples& simulated);

}  // namespace raven_correction
