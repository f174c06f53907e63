// SPDX-License-Identifier: BSD-3-Clause
// What a residual depends on, whatever the cause: the share of it that a delay, position, direction
// of motion, speed, load or time predict on motions not learnt from. Naming a physical cause is
// selection.h.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "raven_correction/diagnosis/residual.h"

namespace raven_correction {

/// What one group of features predicts.
struct Dependence {
  std::string on;      ///< "delay", "position", "direction", "speed", "load", "time", or "anything"
  double share = 0.0;  ///< of the squared residual about its mean, channels equal [-]
  double lower = 0.0;  ///< 95 % interval over motions
  double upper = 0.0;
};

struct DependenceResult {
  std::vector<Dependence> groups;
  Dependence anything;            ///< all groups together
  Dependence on_delay;            ///< what one delay of everything would explain; speed contains it
  double delay = 0.0;             ///< that delay [s]
  double position_rms = 0.0;      ///< of what they predict of the position [m]; 0 for joint data
  double orientation_rms = 0.0;   ///< of what they predict of the orientation [rad]
  std::vector<double> joint_rms;  ///< joint data: of what they predict of each joint [rad or m]
};

/// Ridge regression of the residual on functions of the simulated joints, group by group, each
/// motion predicted from the motions of the other folds:
///
///   delay      one delay of everything: a multiple of the velocity of what was seen
///   position   polynomials of second order and waves of two lengths of every joint
///   direction  smoothed signs of the joint speeds, and the state of plays of two widths (history)
///   speed      joint speeds, their size and square
///   load       gravity on every joint and its squares (recordings with kinematics and masses)
///   time       polynomials and waves over the session
///
/// Components are clipped at three robust deviations, so that single wrong samples do not rule.
/// Encoder channels are left out. Ridge: weights w of features of unit variance minimise
/// |X w - y|^2 + 0.01 n |w|^2 over the n samples of the other folds, the constant free.
/// @param residual   of any simulation of the recording, layout.size
/// @param joints     that the features are made of, one column per block: as a rule those of the
///        simulation that was given, so that before and after have the same features
/// @param simulated  what the simulation that left the residual says: the frame of its orientation
/// @param folds      motion i is predicted from the motions that are not in fold i % folds
/// @param seed       of the bootstrap over motions that the intervals come from
/// @return groups in the order above, those without features left out; empty without samples
/// Source of ridge regression: Hoerl, Kennard 1970, doi:10.1080/00401706.1970.10488634
DependenceResult residualDependence(const Recording& recording, const ResidualLayout& layout,
                                    const Eigen::VectorXd& residual, const Eigen::MatrixXd& joints,
                                    const SimulatedSamples& simulated, int folds,
                                    std::uint64_t seed);

}  // namespace raven_correction
