// SPDX-License-Identifier: BSD-3-Clause
// How far motion capture lags behind the commands at present, by the speeds in the last minute of
// both streams (dataset/speed_delay.h), against the same of what the model in use was trained on: a
// clock that is off, of one host against another, shows as a change.
#pragma once

#include <future>
#include <limits>
#include <string>

#include "raven_correction/dataset/delay.h"
#include "raven_correction/geometry/stream.h"

namespace raven_correction {

struct DelayWatchOptions {
  double window = 60.0;      ///< of both streams that an estimate looks at, > 0 [s]
  double max_change = 0.03;  ///< a larger difference from the model's is reported; 0: none is [s]
};

/// Of one thread, which never waits: estimates are made in another one.
class DelayWatch {
 public:
  static constexpr double kRange = 0.2;  ///< a change beyond it is reported as "at least" this [s]

  /// @throws InvalidInput  an option is negative or not finite, or the window is zero
  explicit DelayWatch(const DelayWatchOptions& options);

  /// What the delay is held against. What was estimated about another model is forgotten.
  /// @param delay  Correction::speed_delay [s]; nan: the model knows of none, and nothing is held
  ///               against it
  void setModel(const std::string& id, double delay);
  /// Samples in any one frame each, by increasing stamp: later ones that go back are left out. At
  /// most 200 a second are kept.
  void addCommand(const StampedPose& command) { add(command, commands_); }
  void addObservation(const StampedPose& observation) { add(observation, observations_); }
  /// Forgets the streams (after a jump of the clock), and what was estimated.
  void clear();

  /// To be called now and then: takes in the estimate that was made meanwhile, and begins the next
  /// one when a quarter of the window is new and both streams fill half of it.
  void update();
  bool estimating() const { return estimate_.valid(); }  ///< an estimate is not taken in yet

  bool known() const { return status_ == DelayResult::Status::kOk || atLimit(); }
  double delay() const { return delay_; }             ///< where known() [s]
  double modelDelay() const { return model_delay_; }  ///< nan: there is none [s]
  /// The difference exceeds max_change: both delays, and the remedy. Empty: it does not, or there
  /// is no model, or too little motion.
  const std::string& message() const { return message_; }

 private:
  bool atLimit() const { return status_ == DelayResult::Status::kAtLimit; }
  void add(const StampedPose& sample, PoseStream& stream);
  void take(const DelayResult& result);

  const DelayWatchOptions options_;
  std::string model_;
  double model_delay_ = std::numeric_limits<double>::quiet_NaN();
  PoseStream commands_, observations_;
  double estimated_at_ = -std::numeric_limits<double>::infinity();  // newest observation then
  bool stale_ = false;  // the estimate that is made is of what was forgotten

  DelayResult::Status status_ = DelayResult::Status::kNotRun;
  double delay_ = 0.0;
  std::string message_;

  std::future<DelayResult> estimate_;  // last: its end is waited for first
};

}  // namespace raven_correction
