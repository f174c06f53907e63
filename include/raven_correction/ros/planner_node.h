// SPDX-License-Identifier: BSD-3-Clause
// The node `planner`: moves the tool between random fragment positions, grasps and lets go there
// where the motion is a debridement, and says where each motion begins, where it is meant to end
// and when it has ended.
#pragma once

#include <geometry_msgs/PoseStamped.h>
#include <ros/ros.h>
#include <std_srvs/Trigger.h>

#include <atomic>
#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "raven_correction/RunPlanner.h"
#include "raven_correction/WorkProgress.h"
#include "raven_correction/ros/playback.h"
#include "raven_correction/simulation/debridement_motion.h"

namespace raven_correction {

struct PlannerParams {
  std::string robot;                  ///< robot YAML, for what it can reach; required
  std::string base_frame = "0_link";  ///< of the poses
  bool debridement = false;  ///< the whole cycle of the task; otherwise fragment to fragment
  DebridementConfig motion;
  double silence = 0.3;        ///< between two motions [s], in [0, 10]
  double stop_time = 0.3;      ///< to come to rest when stopped [s], in [0, 5]
  double start_timeout = 5.0;  ///< to wait for listeners and for setpoint_cp [s, real], (0, 60]
};
/// @throws InvalidInput  lists all problems
PlannerParams loadPlannerParams(const ros::NodeHandle& nh);

/// `~run` moves in the thread of its service call, so the node needs a spinner with at least three
/// threads: run, stop, and what arrives meanwhile.
class PlannerNode {
 public:
  static constexpr int kThreads = 3;

  /// @param nh  in the arm's namespace
  /// @throws InvalidInput  the robot file cannot be read, or the robot cannot reach the field
  PlannerNode(const ros::NodeHandle& nh, const ros::NodeHandle& private_nh,
              const PlannerParams& params);

 private:
  struct Outcome {
    bool success = false;
    std::string message;
    unsigned completed = 0;
  };
  bool onRun(RunPlanner::Request& request, RunPlanner::Response& response);
  bool onStop(std_srvs::Trigger::Request&, std_srvs::Trigger::Response& response);
  Outcome runMotions(const RunPlanner::Request& request);
  DebridementTrajectory nextMotion(const std::vector<Pose>& targets, unsigned i,
                                   DebridementMotion& motion) const;
  std::optional<Pose> startPose();
  bool play(const PoseStream& motion, const std::vector<double>& jaw, double start,
            double& last_stamp);
  bool rest();
  void announce(const std::string& name, const DebridementTrajectory& trajectory, double start);
  void endOf(const std::string& name, const DebridementTrajectory& trajectory, double stamp,
             bool completed);
  void progress(std::uint8_t state, const std::string& phase, double fraction, double time_left,
                const std::string& message);

  PlannerParams params_;
  KinematicChain robot_;
  std::atomic<bool> running_{false};
  std::atomic<bool> stop_{false};
  std::optional<StampedPose> last_desired_;  // sent last; belongs to the running motion
  std::optional<Pose> setpoint_at_end_;      // of the controller when that motion had ended

  std::mutex mutex_;  // guards what follows
  std::optional<Pose> setpoint_;

  ros::NodeHandle nh_;
  ros::Publisher desired_;
  ros::Publisher jaw_;
  ros::Publisher path_;
  ros::Publisher event_;
  ros::Publisher progress_;
  ros::Subscriber setpoint_subscriber_;
  ros::ServiceServer run_;
  ros::ServiceServer stop_service_;
};

}  // namespace raven_correction
