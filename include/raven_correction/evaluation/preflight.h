// SPDX-License-Identifier: BSD-3-Clause
// Whether a model is valid for the robot as it is today: a few moves under motion capture, judged
// as held-out trajectories are (validated_training.h), but by medians over all plausible states: a
// robot that is far off must not lose its worst states to a gate.
#pragma once

#include <cstddef>
#include <limits>
#include <string>

#include "raven_correction/correction/model.h"
#include "raven_correction/geometry/stream.h"

namespace raven_correction {

struct PreflightLimits {
  /// The median error may be this many times what the model promises (its held-out error), > 0 [-].
  double factor = 3.0;
  double max_position = 0.008;    ///< and never more than this, > 0 [m]
  double max_angle = 0.15;        ///< the same, > 0 [rad]
  double least_position = 0.001;  ///< a promise below this counts as this, >= 0 [m]
  double least_angle = 0.0175;    ///< the same, >= 0 [rad]
  std::size_t min_poses = 200;    ///< states that can be judged, > 0 [1]
  double min_extent = 0.03;       ///< diagonal of the box about their commands, >= 0 [m]
};

struct PreflightResult {
  enum class Status {
    kNotRun,
    kPassed,
    kFailed,       ///< the model is too far off
    kNotObserved,  ///< too few poses, or hardly any motion: nothing can be said
  };
  Status status = Status::kNotRun;
  std::string message = "no pre-flight has run";  ///< one sentence, with the remedy
  std::size_t poses = 0;                          ///< states that were judged [1]
  double extent = 0.0;                            ///< diagonal of the box about their commands [m]
  static constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  double position = kNone;              ///< of predicted from sent commands, median [m]
  double angle = kNone;                 ///< the same [rad]
  double uncorrected_position = kNone;  ///< of observed poses from sent commands, median [m]
  double uncorrected_angle = kNone;     ///< the same [rad]
  double promised_position = kNone;     ///< norm of the model's mean absolute errors, held-out [m];
                                        ///< nan: it was not validated
  double promised_angle = kNone;        ///< the same of ZYX angles [rad]
  double max_position = kNone;          ///< that was in force [m]
  double max_angle = kNone;             ///< [rad]
};

/// For every plausible state (test_states.h) of the observations: the command that the model
/// predicts for the pose that was seen, against the command that was sent `delay` of the model
/// before. It passes if both medians are within
///
///   min(max, factor max(least, promise)),   promise: held-out error of the model; none: max
///
/// and their mean ratio to the errors without correction is below 1. (Where errors are normal, the
/// norm of mean absolute errors that the promise is, is 0.9 times the median of their norms.)
/// @param commands      sent to the controller, in base, by increasing stamp
/// @param observations  of motion capture, in base, by increasing stamp
/// @throws InvalidInput  a limit out of its range, or see Predictor
PreflightResult judgePreflight(const Correction& model, const PoseStream& commands,
                               const PoseStream& observations, const PreflightLimits& limits);

}  // namespace raven_correction
