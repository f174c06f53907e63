// SPDX-License-Identifier: BSD-3-Clause
// What the overlay remembers: where the tool was wanted, sent and seen lately, and how far apart
// wanted and seen were, with and without correction. Knows no message; drawing is
// overlay_markers.h.
#pragma once

#include <cstddef>
#include <deque>
#include <optional>

#include "raven_correction/geometry/stream.h"
#include "raven_correction/ros/live_synchroniser.h"

namespace raven_correction {

/// Where the tool was seen against where it was wanted, at one instant. All poses in base.
struct TrackingError {
  double stamp = 0.0;      ///< of the observation [s]
  Pose desired;            ///< at stamp - delay
  Pose observed;           ///< at stamp
  bool corrected = false;  ///< the command of that instant was corrected
  double position() const { return (observed.p - desired.p).norm(); }    ///< [m]
  double angle() const { return rotationAngle(desired.q, observed.q); }  ///< [rad]
};

struct MeanError {
  double position = 0.0;    ///< mean distance [m]
  double angle = 0.0;       ///< mean rotation angle [rad]
  std::size_t samples = 0;  ///< [1]; 0: none yet
};

struct OverlayHistoryOptions {
  double delay = 0.0;            ///< observation behind command [s]
  double trail_duration = 10.0;  ///< of the trails [s]
  double error_duration = 30.0;  ///< of the errors remembered for drawing [s]
  double error_period = 0.2;     ///< between two of them [s]
};

class OverlayHistory {
 public:
  explicit OverlayHistory(const OverlayHistoryOptions& options);

  void addDesired(const StampedPose& desired);
  void addCommand(const StampedPose& command);
  void addObserved(const StampedPose& observed);
  /// What the corrector said about the desired pose of that stamp.
  void addStatus(double stamp, bool corrected);
  void setDelay(double delay) { options_.delay = delay; }
  double delay() const { return options_.delay; }  ///< [s]
  void clear();

  /// At most one sample per 20 ms, the newest always among them; stamps increase.
  const std::deque<StampedPose>& desired() const { return desired_; }
  const std::deque<StampedPose>& command() const { return command_; }
  const std::deque<StampedPose>& observed() const { return observed_; }

  /// The command of an instant, from the trail; nothing where it does not reach. @param instant [s]
  std::optional<Pose> commandAt(double instant) const;

  /// The newest; the command plays the desired pose where the planner publishes none.
  const std::optional<TrackingError>& latest() const { return latest_; }
  /// One per error_period, oldest first.
  const std::deque<TrackingError>& errors() const { return errors_; }
  /// Over the latest observations of this kind (some ten seconds at 480 Hz).
  MeanError mean(bool corrected) const;

 private:
  struct Status {
    double stamp = 0.0;
    bool corrected = false;
  };
  struct Sums {
    std::deque<MeanError> samples;
    double position = 0.0, angle = 0.0;
  };

  void extend(std::deque<StampedPose>& trail, const StampedPose& sample) const;
  void take(const std::vector<LivePair>& pairs);
  bool wasCorrected(double stamp) const;

  OverlayHistoryOptions options_;
  LiveSynchroniser against_desired_, against_command_;
  std::deque<StampedPose> desired_, command_, observed_;
  std::deque<Status> statuses_;
  std::optional<TrackingError> latest_;
  std::deque<TrackingError> errors_;
  Sums sums_[2];  // without, with correction
};

}  // namespace raven_correction
