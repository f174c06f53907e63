// SPDX-License-Identifier: BSD-3-Clause
// A simulated arm together with everything that reports about it, brought forward in time, alone or
// beside others: which samples of encoders, set-points and motion capture fall into an interval.
#pragma once

#include <cstdint>
#include <deque>
#include <limits>
#include <vector>

#include "raven_correction/simulation/simulated_arm.h"

namespace raven_correction {

/// How often the controller reports [Hz], each in (0, 1000].
struct ReportRates {
  double measured_cp = 100.0;
  double setpoint_cp = 100.0;
  double measured_js = 100.0;
};

/// The jaw has passed grasp_opening.
struct JawPassage {
  double stamp = 0.0;    ///< at most a report later than it was [s]
  bool closed = false;   ///< otherwise it was opened
  double opening = 0.0;  ///< closed: the widest since it was opened; otherwise of now [rad]
  Pose X_base_tool;      ///< true, without noise
};

/// What was reported in one interval, each stream in the order of its stamps.
struct CellReport {
  PoseStream measured;                ///< forward kinematics of the encoders, base frame
  PoseStream setpoint;                ///< what the controller aims at, base frame
  std::vector<StampedJoints> joints;  ///< of the encoders, in the order of the robot's joints
  std::vector<StampedJoints> jaw;     ///< opening, one value [rad]; with `joints`
  PoseStream mocap;                   ///< the tool as motion capture saw it, base frame
  std::vector<JawPassage> passages;   ///< of the jaw
  /// Smallest distance between the instrument of this arm and those of the arms that share its base
  /// frame [m]; infinite without one, negative where they have met.
  double clearance = std::numeric_limits<double>::infinity();
};

/// Deterministic from its seed, its commands and the instants it is asked for. Not thread-safe.
class SimulatedCell {
 public:
  /// The arm rests at its homing position.
  /// @param start  [s]
  /// @throws InvalidInput  a rate out of its range, or a bad configuration
  SimulatedCell(const SimulationConfig& config, const ReportRates& rates, std::uint64_t seed,
                double start);

  /// See SimulatedArm::command().
  IkStatus command(const StampedPose& X_base_tool) noexcept { return arm_.command(X_base_tool); }
  /// See SimulatedArm::commandJaw().
  bool commandJaw(double stamp, double opening) noexcept { return arm_.commandJaw(stamp, opening); }
  /// Moves on and says what was reported meanwhile. Motion capture reports a frame when its stamp
  /// has come, so that latency delays the message, too.
  /// @param time  [s]; one before the last adds nothing
  /// @return valid until the next call
  const CellReport& advanceTo(double time);
  /// What was reported while it was advanced last.
  const CellReport& report() const noexcept { return report_; }
  /// Puts the arm back to rest at its homing position; reports go on from `start`.
  void reset(double start);
  /// Goes on at `start` after the clock has jumped, with the arm where it is and what it holds:
  /// plays, lags, creep and shifts go on as if no time had passed. Pending commands are forgotten.
  void restart(double start);

  const SimulatedArm& arm() const noexcept { return arm_; }
  double time() const noexcept { return arm_.time(); }

  friend void advanceTogether(const std::vector<SimulatedCell*>& cells, double time);

 private:
  void restartReports(double start);
  double nextReport() const noexcept;
  void reportAt(double time, const std::vector<Obstacle>& obstacles);
  void endReports(double time);
  void noticeJaw(double time);

  ReportRates rates_;
  SimulatedArm arm_;
  MotionCapture motion_capture_;
  double next_measured_ = 0.0;
  double next_setpoint_ = 0.0;
  double next_joints_ = 0.0;
  std::deque<StampedPose> in_flight_;  // frames whose stamp has not come yet
  CellReport report_;
  bool jaw_open_ = false;
  double widest_ = 0.0;  // opening since the jaw was opened [rad]
};

/// Moves on several arms that stand in one room, as advanceTo() does with one. At every exposure
/// the instruments of the other arms are where they are at that instant, and hide what is behind
/// them from the cameras, where the robots share a base frame. So reports do not depend on how
/// often one asks.
/// @param cells  none null, none twice; report() of each says what was reported meanwhile
/// @param time   to move on to [s]; one before the last of a cell adds nothing to its reports
void advanceTogether(const std::vector<SimulatedCell*>& cells, double time);

}  // namespace raven_correction
