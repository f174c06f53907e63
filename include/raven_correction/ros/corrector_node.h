// SPDX-License-Identifier: BSD-3-Clause
// The corrector between planner and controller: the command topic with its clock, frames, robot
// state and master. What happens to a pose of an arm is corrected_arm.h, every number
// correction/corrector.h. The same class is the node and the nodelet.
#pragma once

#include <dynamic_reconfigure/server.h>
#include <raven_correction/CorrectorConfig.h>
#include <ros/callback_queue.h>
#include <ros/ros.h>

#include <memory>
#include <string>
#include <tuple>
#include <vector>

#include "raven_correction/ros/corrected_arm.h"
#include "raven_correction/ros/homing_watch.h"
#include "raven_correction/ros/latched_replay.h"
#include "raven_correction/ros/master_watch.h"

namespace raven_correction {

class CorrectorNode {
 public:
  /// Poses are handled by one thread of their own, models and questions to the master by one each,
  /// checks and pre-flights by some that may wait, what switches the correction on or off by two
  /// (on may have to wait for a model, off never waits), everything else by whoever spins the queue
  /// of the node handles.
  /// @throws InvalidInput  see loadCorrectorParams() and CorrectedArm
  CorrectorNode(const ros::NodeHandle& nh, const ros::NodeHandle& private_nh);
  ~CorrectorNode();

  /// That ~realtime_priority asks for; 0: none. The live thread has it where the system allows it.
  int realtimePriority() const noexcept { return params_.realtime_priority; }

  /// The callback of the command topic, of the live thread. After the first message nothing of ours
  /// in it allocates, locks, or throws.
  template <typename Message>
  void onDesired(const ros::MessageEvent<Message const>& event);

 private:
  using Outputs = std::array<CorrectorOutput, kMaxCorrectedArms>;

  template <typename Message>
  void subscribeDesired();
  bool decide(bool readable, bool latched, double now, CommandRequest& request, Outputs& outputs);
  void watchClock(const ros::Time& now);
  void watchRobotState(const ros::SteadyTime& now);
  void onRobotState(const ros::MessageEvent<AnyMessage const>& event);
  void onTuning(CorrectorConfig& config);
  void noteMaster(const MasterView& view);
  void lookAtTopics();
  void watchOutput();
  CorrectionHold holdNow() const noexcept;
  void updateHold() noexcept;
  void offerServices(const std::string& ns, const std::vector<CorrectedArm*>& arms);
  void offerPreflight(CorrectedArm& arm);

  ros::NodeHandle nh_, private_nh_;
  const CorrectorParams params_;
  std::vector<std::string> arm_names_;

  // Declared before what is in it.
  ros::CallbackQueue live_queue_, model_queue_, master_queue_, check_queue_, switch_queue_;
  std::vector<std::unique_ptr<CorrectedArm>> arms_;

  // Of the live thread alone.
  LatchedReplay replays_;
  ros::Time last_now_;
  std::tuple<MessagePool<geometry_msgs::PoseStamped>, MessagePool<geometry_msgs::TransformStamped>,
             MessagePool<RavenCommand>>
      pools_;
  HomingWatch homing_watch_;
  bool robot_state_warned_ = false;

  // Set by one thread each, read by holdNow().
  std::atomic<bool> robot_ready_{true}, alone_{true};

  // Of the thread that asks the master.
  Registrations registrations_;
  bool forgotten_ = false;  // by the master, which has not been told of everything yet
  bool master_lost_ = false;
  std::string other_publisher_;  // a node that the master knows; empty: none

  ros::Publisher command_publisher_;
  std::vector<ros::ServiceServer> services_;
  CorrectorConfig tuning_in_force_;
  std::unique_ptr<dynamic_reconfigure::Server<CorrectorConfig>> tuning_;
  // Declared last: their callbacks use everything above.
  ros::Subscriber desired_subscriber_, robot_state_subscriber_;
  ros::WallTimer master_timer_, topics_timer_;
  std::unique_ptr<ros::AsyncSpinner> live_spinner_, model_spinner_, master_spinner_, check_spinner_,
      switch_spinner_;
};

}  // namespace raven_correction
