// SPDX-License-Identifier: BSD-3-Clause
// The corrector between planner and controller: topics, services, parameters and diagnostics
// around correction/corrector.h, which makes every decision about a pose.
#pragma once

#include <diagnostic_updater/diagnostic_updater.h>
#include <geometry_msgs/PoseArray.h>
#include <geometry_msgs/PoseStamped.h>
#include <geometry_msgs/TransformStamped.h>
#include <raven_correction/CorrectionModel.h>
#include <raven_correction/CorrectionStatus.h>
#include <raven_correction/SetMode.h>
#include <ros/callback_queue.h>
#include <ros/ros.h>
#include <std_srvs/SetBool.h>

#include <array>
#include <atomic>
#include <memory>
#include <mutex>
#include <set>
#include <string>

#include "raven_correction/correction/corrector.h"
#include "raven_correction/ros/params.h"

namespace raven_correction {

struct CorrectorParams {
  std::string base_frame = "0_link";      ///< the only frame that is accepted
  std::string pose_type = "PoseStamped";  ///< of desired/servo_cp and servo_cp
  std::string mode = "full";              ///< that ~enable switches on
  bool enabled = false;                   ///< at start
  std::string model;                      ///< model file to start with; empty: wait for the topic
  CorrectorLimits limits;
};
/// @throws InvalidInput  lists every problem
CorrectorParams loadCorrectorParams(const ros::NodeHandle& nh);

class CorrectorNode {
 public:
  /// Poses are handled by one thread of their own, everything else by whoever spins the global
  /// queue.
  /// @throws InvalidInput  see loadCorrectorParams() and readModelFile()
  CorrectorNode(const ros::NodeHandle& nh, const ros::NodeHandle& private_nh);
  ~CorrectorNode();

 private:
  template <typename Message>
  void subscribeDesired();
  template <typename Message>
  void onDesired(const ros::MessageEvent<Message const>& event);
  bool isStaleLatched(const ros::M_string& header);
  bool isEndpoint(const Pose& desired) const;
  void onPath(const geometry_msgs::PoseArray& path);
  void onModel(const CorrectionModel& msg);
  void useModel(const Correction& model);
  void setMode(CorrectorMode mode);
  bool onSetMode(SetMode::Request& request, SetMode::Response& response);
  bool onEnable(std_srvs::SetBool::Request& request, std_srvs::SetBool::Response& response);
  void diagnose(diagnostic_updater::DiagnosticStatusWrapper& status);

  ros::NodeHandle nh_, private_nh_;
  CorrectorParams params_;
  Corrector corrector_;

  // Of the live thread alone.
  std::set<std::string> latched_publishers_;
  ros::Time last_now_;
  Pose path_first_, path_last_;
  bool has_path_ = false;

  // Counted by the live thread, read by diagnostics.
  std::array<std::atomic<std::uint64_t>, 32> counts_{};
  std::atomic<double> worst_compute_time_{0.0};

  // Guarded by mutex_.
  std::mutex mutex_;
  std::string model_id_;
  std::array<std::uint64_t, 32> reported_{};

  diagnostic_updater::Updater diagnostics_;
  ros::Publisher command_publisher_, status_publisher_;
  // Declared last: their callbacks use everything above.
  ros::CallbackQueue live_queue_;
  ros::NodeHandle live_nh_;
  ros::Subscriber desired_subscriber_, path_subscriber_, model_subscriber_;
  ros::ServiceServer mode_service_, enable_service_;
  ros::Timer diagnostics_timer_;
  std::unique_ptr<ros::AsyncSpinner> live_spinner_;
};

}  // namespace raven_correction
