// SPDX-License-Identifier: BSD-3-Clause
// The node `simulator`: stands where a robot controller and a motion-capture system stand, with
// their topics, their rates and their rules.
#pragma once

#include <diagnostic_updater/diagnostic_updater.h>
#include <geometry_msgs/PoseStamped.h>
#include <ros/ros.h>
#include <std_srvs/Trigger.h>
#include <tf2_ros/static_transform_broadcaster.h>

#include <memory>
#include <string>
#include <vector>

#include "raven_correction/LoadModel.h"
#include "raven_correction/ros/command_gate.h"
#include "raven_correction/ros/simulated_cell.h"
#include "raven_correction/ros/simulator_clock.h"

namespace raven_correction {

struct SimulatorParams {
  std::string simulation;  ///< simulation YAML; required
  int seed = 1;            ///< of the motion capture's noise, in [0, 2^31)
  ReportRates rates;
  std::string base_frame = "0_link";  ///< of commands and of measured_cp
  std::string mocap_frame = "mocap";  ///< of mocap/measured_cp
  Pose X_base_mocap;                  ///< registration, published on /tf_static
  CommandGateConfig gate;
  double loop_rate = 1000.0;       ///< of the controller [Hz, real time], in [50, 2000]
  double clock_rate = 0.0;         ///< simulated per real seconds; 0: follow the ROS clock
  double clock_frequency = 250.0;  ///< messages on /clock [Hz, real time], in [10, 1000]
};
/// @throws InvalidInput  lists all problems
SimulatorParams loadSimulatorParams(const ros::NodeHandle& nh);

/// One thread: callbacks are served in the controller's loop, so nothing is locked.
class SimulatorNode {
 public:
  /// @param nh      in the arm's namespace
  /// @throws InvalidInput  the simulation file cannot be read
  SimulatorNode(const ros::NodeHandle& nh, const ros::NodeHandle& private_nh,
                const SimulatorParams& params);
  /// The controller's loop, until ROS shuts down.
  void run();

 private:
  double now();
  void cycle(double time);
  void publish(const CellReport& report);
  void publishRegistration();
  void publishClock(double time, double steady);
  void onCommand(const ros::MessageEvent<geometry_msgs::PoseStamped const>& event);
  bool onReset(std_srvs::Trigger::Request&, std_srvs::Trigger::Response& response);
  bool onLoad(LoadModel::Request& request, LoadModel::Response& response);
  void report(diagnostic_updater::DiagnosticStatusWrapper& status);

  SimulatorParams params_;
  SimulationConfig config_;
  std::unique_ptr<SimulatorClock> clock_;  // null: the ROS clock is followed
  std::unique_ptr<SimulatedCell> cell_;    // null: the clock has not started
  CommandGate gate_;
  std::vector<std::string> joint_names_;
  Pose X_mocap_base_;
  double last_clock_ = 0.0;  // when /clock was published last, steady [s]
  std::uint64_t cycles_ = 0;
  std::uint64_t late_cycles_ = 0;
  double worst_lateness_ = 0.0;  // of a cycle since the last diagnostics [s]

  ros::NodeHandle nh_;
  ros::Publisher measured_;
  ros::Publisher setpoint_;
  ros::Publisher joints_;
  ros::Publisher mocap_;
  ros::Publisher clock_publisher_;
  tf2_ros::StaticTransformBroadcaster static_broadcaster_;
  diagnostic_updater::Updater diagnostics_;
  ros::Subscriber command_;
  ros::ServiceServer reset_;
  ros::ServiceServer load_;
};

}  // namespace raven_correction
