// SPDX-License-Identifier: BSD-3-Clause
// The topics and services of one simulated arm: what its controller and its motion capture take and
// report in the arm's namespace. The loop that drives one arm or several is simulator_node.h.
#pragma once

#include <diagnostic_updater/diagnostic_updater.h>
#include <geometry_msgs/PoseStamped.h>
#include <geometry_msgs/TransformStamped.h>
#include <ros/ros.h>
#include <sensor_msgs/JointState.h>
#include <std_srvs/Trigger.h>

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "raven_correction/LoadModel.h"
#include "raven_correction/ros/arrival.h"
#include "raven_correction/ros/command_gate.h"
#include "raven_correction/ros/latched_replay.h"
#include "raven_correction/ros/simulated_cell.h"

namespace raven_correction {

struct SimulatedArmParams {
  std::string name;        ///< its namespace below the node's; empty: the node's own
  std::string simulation;  ///< simulation YAML; required
  int seed = 1;            ///< of the motion capture's noise, in [0, 2^31)
  ReportRates rates;
  std::string base_frame = "0_link";  ///< of commands and of measured_cp; the robot's own
  std::string mocap_frame = "mocap";  ///< of mocap/measured_cp
  Pose X_base_mocap;                  ///< registration, published on /tf_static
  CommandGateConfig gate;
};

/// Callbacks are served in the controller's loop, so nothing is locked.
class SimulatedArmPort {
 public:
  /// @param nh    in the arm's namespace
  /// @param node  name of the node: services are NODE/reset and NODE/load in the arm's namespace
  /// @throws InvalidInput  the simulation file cannot be read
  SimulatedArmPort(const ros::NodeHandle& nh, const std::string& node,
                   const SimulatedArmParams& params);

  /// The clock has started: from here on commands are taken.
  /// @param time  [s]
  void start(double time);
  /// The clock has jumped to `time` [s]: pending commands are forgotten, the arm stays where it is.
  void restart(double time) { cell_->restart(time); }
  /// What the loop brings forward; null before start().
  SimulatedCell* cell() noexcept { return cell_.get(); }
  /// Sends what the arm reported while it was brought forward last.
  void publish();
  geometry_msgs::TransformStamped registration() const;
  const SimulatedArmParams& params() const noexcept { return params_; }
  const SimulationConfig& simulation() const noexcept { return config_; }
  void diagnose(diagnostic_updater::DiagnosticStatusWrapper& status) const;

 private:
  void onCommand(const ros::MessageEvent<geometry_msgs::PoseStamped const>& event);
  void onJaw(const ros::MessageEvent<sensor_msgs::JointState const>& event);
  bool onReset(std_srvs::Trigger::Request&, std_srvs::Trigger::Response& response);
  bool onLoad(LoadModel::Request& request, LoadModel::Response& response);
  void use(const SimulationConfig& config);

  SimulatedArmParams params_;
  SimulationConfig config_;
  std::unique_ptr<SimulatedCell> cell_;  // null: the clock has not started
  LatchedReplay replays_;
  CommandGate gate_;
  Arrival jaw_arrival_;
  std::uint64_t jaw_taken_ = 0;
  std::uint64_t jaw_refused_ = 0;
  std::vector<std::string> joint_names_;
  Pose X_mocap_base_;

  ros::NodeHandle nh_;
  ros::Publisher measured_;
  ros::Publisher setpoint_;
  ros::Publisher joints_;
  ros::Publisher jaw_;
  ros::Publisher mocap_;
  ros::Publisher jaw_event_;
  ros::Subscriber command_;
  ros::Subscriber jaw_command_;
  ros::ServiceServer reset_;
  ros::ServiceServer load_;
};

}  // namespace raven_correction
