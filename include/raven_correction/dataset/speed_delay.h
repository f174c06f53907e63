// SPDX-License-Identifier: BSD-3-Clause
// How far the observation lags behind the command, from speeds alone: registration and errors of
// the robot that stay hardly change a speed, so a minute of motion tells it to some milliseconds.
// It is not the delay that explains positions best (delay.h), which a lag of the joints makes
// larger: hold one only against another of its own kind.
#pragma once

#include "raven_correction/dataset/delay.h"

namespace raven_correction {

struct SpeedDelayProblem {
  double min = 0.0;                ///< smallest delay tried [s]
  double max = 0.4;                ///< largest delay tried [s]
  double step = 0.01;              ///< of the search, refined by a parabola [s]
  double least_correlation = 0.7;  ///< of speeds that belong together [-]
};

/// The delay at which the speed of the tool (over 0.1 s) correlates best with that of its commands,
/// over all trajectories together. Streams of a trajectory may be in any one frame each.
/// @return kNotObservable where fewer than 200 instants can be compared, the commands hardly move,
/// or
///         speeds agree too little at every delay; `tried` and `residual` (one minus the
///         correlation) as far as they were asked for
/// @throws InvalidInput  min >= max, or a step that is not positive
DelayResult estimateSpeedDelay(const Dataset& dataset, const SpeedDelayProblem& problem);

}  // namespace raven_correction
