// SPDX-License-Identifier: BSD-3-Clause
// The node `simulator`: stands where a robot controller and a motion-capture system stand, for one
// arm or several, with their topics, their rates and their rules. Here is the controller's loop and
// its clock; what one arm takes and reports is simulated_arm_port.h.
#pragma once

#include <diagnostic_updater/diagnostic_updater.h>
#include <ros/ros.h>
#include <std_srvs/SetBool.h>
#include <tf2_ros/static_transform_broadcaster.h>

#include <cstdint>
#include <limits>
#include <memory>
#include <vector>

#include "raven_correction/ros/simulated_arm_port.h"
#include "raven_correction/ros/simulator_clock.h"

namespace raven_correction {

struct SimulatorParams {
  /// One without a name, in the node's own namespace, or up to four with different ones (`arms`).
  std::vector<SimulatedArmParams> arms;
  double loop_rate = 1000.0;       ///< of the controller [Hz, real time], in [50, 2000]
  double clock_rate = 0.0;         ///< simulated per real seconds; 0: follow the ROS clock
  double clock_frequency = 250.0;  ///< messages on /clock [Hz, real time], in [10, 1000]
};
/// What concerns an arm is read as ~NAME for all arms and as ~ARM/NAME for one. Where no ~ARM/seed
/// is given, the arms count up from ~seed.
/// @throws InvalidInput  lists all problems
SimulatorParams loadSimulatorParams(const ros::NodeHandle& nh);

/// With several arms, `~clearance` says how near their instruments have come to one another since
/// the message before. `~pause` lets a clock of the node's own stand still, and with it every arm.
/// One thread: callbacks are served in the controller's loop, so nothing is locked.
class SimulatorNode {
 public:
  /// @param nh      in the arm's namespace, or above those of several
  /// @throws InvalidInput  a simulation file cannot be read
  SimulatorNode(const ros::NodeHandle& nh, const ros::NodeHandle& private_nh,
                const SimulatorParams& params);
  /// The controller's loop, until ROS shuts down.
  void run();

 private:
  double now();
  void cycle(double time);
  void follow(double time);
  void publishRegistrations();
  void publishClock(double time, double steady);
  void report(diagnostic_updater::DiagnosticStatusWrapper& status);
  void watchClearance(double steady);
  bool onPause(std_srvs::SetBool::Request& request, std_srvs::SetBool::Response& response);

  SimulatorParams params_;
  std::unique_ptr<SimulatorClock> clock_;  // null: the ROS clock is followed
  std::vector<std::unique_ptr<SimulatedArmPort>> arms_;
  double time_ = 0.0;        // of the cycle; 0: the clock has not started [s]
  double last_clock_ = 0.0;  // when /clock was published last, steady [s]
  std::uint64_t cycles_ = 0;
  std::uint64_t late_cycles_ = 0;
  double worst_lateness_ = 0.0;        // of a cycle since the last diagnostics [s]
  std::uint64_t reported_cycles_ = 0;  // at the last diagnostics
  double reported_time_ = 0.0;         // [s]
  bool paused_ = false;                // our own clock stands
  double clearance_ = std::numeric_limits<double>::infinity();        // since the last message [m]
  double least_clearance_ = std::numeric_limits<double>::infinity();  // since the start [m]
  double last_clearance_ = 0.0;  // when it was published last, steady [s]

  ros::NodeHandle nh_;
  ros::Publisher clock_publisher_;
  ros::Publisher clearance_publisher_;
  ros::ServiceServer pause_;
  tf2_ros::StaticTransformBroadcaster static_broadcaster_;
  diagnostic_updater::Updater diagnostics_;
};

}  // namespace raven_correction
