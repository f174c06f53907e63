// SPDX-License-Identifier: BSD-3-Clause
// One arm of the debridement as its nodes offer it: desired poses and jaw commands go out, motion
// capture and the corrector's status come in. What is done with it is
// simulation/debridement_task.h.
#pragma once

#include <geometry_msgs/PoseStamped.h>
#include <ros/ros.h>

#include <atomic>
#include <mutex>
#include <optional>
#include <string>

#include "raven_correction/CorrectionStatus.h"
#include "raven_correction/ros/field_eye.h"
#include "raven_correction/ros/registration.h"
#include "raven_correction/simulation/debridement_task.h"
#include "raven_correction/simulation/deviation_replanner.h"

namespace raven_correction {

/// How an arm moves in one condition of the experiment.
struct ArmMotion {
  double speed = 0.06;           ///< peak, along a straight move [m/s]
  double angular_speed = 1.0;    ///< peak [rad/s]
  double acceleration = 0.5;     ///< peak [m/s^2]
  double rate = 50.0;            ///< of desired poses [Hz]
  double look_time = 0.5;        ///< that a picture takes until fragments are known [s]
  double replan_interval = 0.0;  ///< between two measurements of the tool pose [s]; 0: none
  double window = 0.15;          ///< in which motion capture is looked at [s]
  ReplanConfig replan;
  unsigned replans_at_rest = 3;  ///< measurements of replanHere() at most
  double near_enough = 5e-4;     ///< it ends with one that changes no more than this [m]
};

/// Moves in the thread of the caller; callbacks come from a spinner.
class DebridementArm : public DebridementCell {
 public:
  /// @param arm          namespace
  /// @param base_frame   of the poses
  /// @param eye          outlives this
  /// @param interrupted  looked at while it moves; outlives this
  DebridementArm(const std::string& arm, const std::string& base_frame, FieldEye& eye,
                 const std::atomic<bool>& interrupted);

  /// The next motions are of this kind; what was measured before is forgotten: where the tool was
  /// sent is where it was asked to be.
  void use(const ArmMotion& motion);
  /// Measures the deviation at rest, before the first motion.
  /// @throws std::runtime_error  motion capture does not tell it
  void measureAtRest();
  /// Undoes no deviation any more: the tool goes where it errs to.
  void takeBack();
  /// How far the tool at rest is from what was asked for last, by motion capture [m], base frame;
  /// nothing where that does not tell it.
  std::optional<Eigen::Vector3d> deviation();
  const ros::NodeHandle& handle() const noexcept { return nh_; }
  unsigned measurements() const noexcept { return measurements_; }

  double now() override;
  void move(const char* kind, const Pose& X_base_tool, double dwell) override;
  void setJaw(double opening, double dwell) override;
  FieldPicture look() override;
  void wait(double duration) override;
  double predictedDeviation() override;
  bool replanHere() override;

 private:
  void onMocap(const geometry_msgs::PoseStamped& message);
  void stream(PoseStream motion);
  void send(const StampedPose& desired);
  PoseStream seenSince(double stamp);
  bool measure(double now);
  void announce(const char* kind, bool begins, double stamp, const Pose& target);
  Pose start();

  std::string base_frame_;
  FieldEye& eye_;
  const std::atomic<bool>& interrupted_;
  ArmMotion motion_;
  DeviationReplanner replanner_;
  std::optional<Pose> desired_;  // last
  double opening_ = 0.0;         // of the jaw, commanded last [rad]
  double last_stamp_ = 0.0;      // of the last desired pose [s]
  double next_replan_ = 0.0;     // [s]
  PoseStream sent_;              // of the last seconds
  unsigned motions_ = 0;
  unsigned measurements_ = 0;

  std::mutex mutex_;     // guards what follows
  PoseStream observed_;  // of the last seconds, base frame
  std::optional<Pose> setpoint_;
  double predicted_ = 0.0;        // [m]
  double predicted_stamp_ = 0.0;  // of the pose that it is of [s]

  Registration registration_;
  ros::NodeHandle nh_;
  ros::Publisher desired_publisher_, jaw_publisher_, event_publisher_;
  ros::Subscriber mocap_subscriber_, setpoint_subscriber_, status_subscriber_;
};

}  // namespace raven_correction
