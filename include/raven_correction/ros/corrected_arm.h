// SPDX-License-Identifier: BSD-3-Clause
// One arm of the node `corrector`: its correction, the model, path and modes it is told of, and its
// status and diagnostics. The command topic, which two arms may share, is corrector_node.h.
#pragma once

#include <diagnostic_updater/diagnostic_updater.h>
#include <geometry_msgs/PoseArray.h>
#include <geometry_msgs/PoseStamped.h>
#include <raven_correction/CorrectionModel.h>
#include <raven_correction/CorrectionStatus.h>
#include <raven_correction/Preflight.h>
#include <raven_correction/SetMode.h>
#include <ros/callback_queue_interface.h>
#include <ros/ros.h>
#include <std_srvs/SetBool.h>

#include <array>
#include <atomic>
#include <limits>
#include <memory>
#include <mutex>
#include <optional>
#include <string>

#include "raven_correction/correction/corrector.h"
#include "raven_correction/correction/path_follower.h"
#include "raven_correction/dataset/topic_check.h"
#include "raven_correction/ros/arm_observer.h"
#include "raven_correction/ros/corrector_params.h"
#include "raven_correction/ros/homing_watch.h"
#include "raven_correction/ros/latency_histogram.h"
#include "raven_correction/ros/message_pool.h"
#include "raven_correction/ros/pose_command.h"
#include "raven_correction/ros/preflight_gate.h"

namespace raven_correction {

class CorrectedArm {
 public:
  /// @param nh          the namespace of the node; topics are below it in that of the arm
  /// @param private_nh  of the node
  /// @param live_queue   of the thread that handles poses
  /// @param model_queue  of the thread that takes models in, which may need seconds
  /// @param check_queue  of threads that may wait: checks and pre-flights
  /// @throws InvalidInput  a file of the arm cannot be used
  CorrectedArm(const ros::NodeHandle& nh, const ros::NodeHandle& private_nh,
               const CorrectorParams& params, const CorrectedArmParams& arm,
               ros::CallbackQueueInterface& live_queue, ros::CallbackQueueInterface& model_queue,
               ros::CallbackQueueInterface& check_queue);

  // --- of the live thread
  /// Why the request is refused, before anything is done about it.
  /// @param stamp  of the message [s]
  /// @param now    the ROS clock [s]
  std::optional<CorrectorCode> fault(const ArmRequest& request, double stamp,
                                     double now) const noexcept;
  /// What becomes of a request; nothing of it counts unless commit() follows. The command holds, of
  /// a part that was not asked for, what the request holds.
  /// @param request  without fault
  /// @param stamp, now  as for fault()
  CorrectorOutput prepare(const ArmRequest& request, double stamp, double now) noexcept;
  /// @param sent  the command of the last prepare() is sent; false: it is out of reach
  void commit(bool sent) noexcept;
  /// Publishes and counts what became of a request.
  /// @param message  of which the request is a part
  /// @param now      the ROS clock when it came [s]
  /// @param compute_time  from arrival to publication, by the steady clock [s]
  void report(const CommandRequest& message, double now, const ArmRequest& request,
              const CorrectorOutput& output, double compute_time);
  /// Forgets the stream: the clock went back.
  void restart() noexcept;
  /// What was noted was not later than now, however the clock jumped since, or before it began.
  /// @param now  the ROS clock, which has begun [s]
  void boundHomings(double now) noexcept;

  // --- of any thread
  const std::string& ns() const noexcept { return arm_.ns; }
  void setHold(CorrectionHold hold) noexcept { corrector_.setHold(hold); }
  /// @throws InvalidInput  see Corrector
  void setTuning(double gain, double max_translation, double max_rotation) {
    corrector_.setTuning(gain, max_translation, max_rotation);
  }
  /// Why the correction may not be switched on; empty: it may.
  /// @param override_preflight  somebody takes the responsibility
  std::string refusal(CorrectorMode mode, bool override_preflight) const;
  /// After refusal() was empty; with an override it may wait for a model. Thread-safe, and off
  /// wins.
  /// @return false if it is off all the same: the robot was homed, or it was switched off,
  /// meanwhile
  bool setMode(CorrectorMode mode, bool override_preflight);
  CorrectorMode mode() const noexcept { return corrector_.mode(); }
  bool hasModel();
  /// Judges the model that waits, or else the one in use; takes as long as it says.
  void preflight(const Preflight::Request& request, Preflight::Response& response);
  /// Ends a pre-flight that is running, for good.
  void stop() { observer_.stop(); }
  /// The robot was homed just now, or may have been: a model from before may be off. Where
  /// pre-flights are required all of them are void, and the mode is off. Of the live thread,
  /// without lock.
  void noteHoming(HomingWatch::Homing homing) noexcept;
  /// Topics that have to be there, for checkTopics().
  std::vector<TopicType> expectedTopics() const;
  void noteTopics(const std::vector<StreamFinding>& findings);
  /// The master has answered.
  void noteMaster() noexcept { master_heard_at_.store(ros::SteadyTime::now().toSec()); }

 private:
  static constexpr std::size_t kCodes = 32;
  struct ModelSummary {
    std::string id;
    double trained_at = 0.0, homed_at = 0.0, expires_at = 0.0;
  };

  bool isEndpoint(const Pose& desired) const noexcept;
  const Lookahead* lookAhead(double stamp, const Pose& desired, Lookahead& ahead) noexcept;
  void forgetPath() noexcept;
  void onPath(const geometry_msgs::PoseArray& path);
  void onMeasured(const geometry_msgs::PoseStampedConstPtr& measured);
  void onModel(const CorrectionModel& msg);
  void takeModel(std::shared_ptr<const Correction> model);
  void useModel(const std::shared_ptr<const Correction>& model);
  void settle(const std::shared_ptr<const Correction>& model, PreflightState how,
              std::uint32_t homings);
  void updatePreflightState();
  std::shared_ptr<const Correction> candidate() const;
  bool inUseIsCleared() const;
  void diagnosePreflight(diagnostic_updater::DiagnosticStatusWrapper& status);
  void diagnose(diagnostic_updater::DiagnosticStatusWrapper& status);

  ros::NodeHandle nh_;
  const CorrectorParams params_;
  const CorrectedArmParams arm_;
  Corrector corrector_;

  // Of the live thread alone.
  Pose path_first_, path_last_;
  bool has_path_ = false;
  PathFollower path_;
  struct Known {
    Pose pose;  ///< what the planner asked for last: the parts that a later request leaves out
    bool position = false, orientation = false;  ///< are known
  };
  Known known_, next_known_;  // next_known_: once the request is sent
  bool prepared_ = false;     // the last request asked something of corrector_
  bool followed_ = false;     // path_ has followed it, and it is not sent yet
  MessagePool<CorrectionStatus> statuses_;

  // Counted by the live thread, read by diagnostics.
  std::array<std::atomic<std::uint64_t>, kCodes> counts_{};
  LatencyHistogram latency_;
  std::atomic<double> distance_{0.0};
  std::atomic<std::uint64_t> beyond_{0}, ahead_{0};
  std::atomic<ToolKnownBy> tool_known_by_{ToolKnownBy::kNotAsked};

  std::atomic<double> master_heard_at_;  // [s] of the steady clock
  /// By the clock of the recordings, and by that of the trainings [s].
  struct HomingTimes {
    std::atomic<double> at{-std::numeric_limits<double>::infinity()};
    std::atomic<double> unix_time{-std::numeric_limits<double>::infinity()};
  };
  HomingTimes seen_homing_, possible_homing_;  // the last of each kind
  std::atomic<HomingWatch::Homing> homing_{
      HomingWatch::Homing::kNone};  // since a pre-flight passed

  std::atomic<std::uint32_t> offs_{0};  // times it was switched off by somebody
  PreflightGate gate_;
  std::atomic<PreflightState> preflight_state_;  // of the model in use
  ArmObserver observer_;
  std::mutex model_mutex_;  // held by whoever hands a model to corrector_

  // Guarded by mutex_.
  mutable std::mutex mutex_;
  ModelSummary model_;
  std::shared_ptr<const Correction> in_use_, waiting_;  // waiting_: for its pre-flight
  std::string last_preflight_;                          // what it said; empty: none has run
  std::vector<StreamFinding> topic_findings_;
  std::string refusal_;  // of the last model that was refused; empty: the last one was taken
  std::array<std::uint64_t, kCodes> reported_{};
  ros::SteadyTime reported_at_;

  diagnostic_updater::Updater diagnostics_;
  ros::Publisher status_publisher_;
  ros::Subscriber path_subscriber_, measured_subscriber_, model_subscriber_;
  ros::WallTimer diagnostics_timer_;
};

}  // namespace raven_correction
