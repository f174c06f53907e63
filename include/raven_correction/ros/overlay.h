// SPDX-License-Identifier: BSD-3-Clause
// The node `overlay`: shows in rviz where the tool is wanted, where it is sent and where it is
// seen, with the error in words. What is remembered is overlay_history.h, how it looks
// overlay_markers.h.
#pragma once

#include <geometry_msgs/PoseStamped.h>
#include <ros/ros.h>

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "raven_correction/CorrectionModel.h"
#include "raven_correction/CorrectionStatus.h"
#include "raven_correction/TrainingSamples.h"
#include "raven_correction/ros/overlay_history.h"
#include "raven_correction/ros/overlay_markers.h"
#include "raven_correction/ros/registration.h"

namespace raven_correction {

struct OverlayParams {
  std::string base_frame = "0_link";      ///< of all markers
  std::string pose_type = "PoseStamped";  ///< message of servo_cp and desired/servo_cp
  std::string mocap_pose_type = "same";   ///< message of mocap/measured_cp; same: as pose_type
  std::string mocap_frame;  ///< frame of motion capture messages that name none; empty: unknown
  double rate = 20.0;       ///< of the markers [1/s]
  double max_age = 1.0;     ///< a pose that arrived longer ago is not shown [s]
  OverlayHistoryOptions history;  ///< its delay counts until a model brings one
  OverlayStyle style;
};

/// @param nh  private node handle
/// @throws InvalidInput  lists every problem
OverlayParams loadOverlayParams(const ros::NodeHandle& nh);

class Overlay {
 public:
  /// @param nh  names of topics are relative to it
  Overlay(ros::NodeHandle nh, const OverlayParams& params);

 private:
  struct Shown {
    Pose pose;  // in base
    ros::SteadyTime arrived;
  };

  /// Rate of the statuses and the slowest of them, renewed every second.
  struct Pace {
    ros::SteadyTime since;
    double rate = 0.0, slowest = 0.0;  // [1/s], [s]
    unsigned count = 0;
    double worst = 0.0;
    void add(const ros::SteadyTime& now, double compute_time);
  };

  std::optional<StampedPose> inBase(const char* topic, const geometry_msgs::PoseStamped& message,
                                    const std::string& default_frame);
  void onDesired(const geometry_msgs::PoseStampedConstPtr& message);
  void onCommand(const geometry_msgs::PoseStampedConstPtr& message);
  void onObserved(const geometry_msgs::PoseStampedConstPtr& message);
  void onStatus(const CorrectionStatusConstPtr& message);
  void onModel(const CorrectionModelConstPtr& message);
  void onSamples(const TrainingSamplesConstPtr& message);
  void drawTraining();
  void onTimer();
  void watchClock();
  bool recent(const ros::SteadyTime& arrived) const;
  std::optional<Pose> recentPose(const std::optional<Shown>& shown) const;
  std::vector<std::string> statusLines() const;

  ros::NodeHandle nh_;
  OverlayParams params_;
  Registration registration_;
  OverlayHistory history_;
  std::optional<Shown> desired_, command_, observed_;
  CorrectionStatusConstPtr status_;
  ros::SteadyTime status_arrived_;
  Pace pace_;
  CorrectionModelConstPtr model_;
  TrainingSamplesConstPtr samples_;
  std::map<std::string, std::string> unregistered_;  // topic to what is missing, while it is
  ros::Time last_time_;

  ros::Publisher publisher_, training_publisher_;
  std::vector<ros::Subscriber> subscribers_;
  ros::WallTimer timer_;
};

}  // namespace raven_correction
