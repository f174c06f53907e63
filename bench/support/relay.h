// SPDX-License-Identifier: BSD-3-Clause
// What the corrector is compared with: a node that subscribes to the planner's poses and publishes
// what it gets. It is the benchmark's own program, started again.
#pragma once

#include <geometry_msgs/PoseStamped.h>
#include <ros/ros.h>

#include <cstdlib>
#include <cstring>
#include <string>

#include "bench/support/own_master.h"
#include "raven_correction/ros/realtime.h"

namespace raven_correction {
namespace bench {

constexpr char kRelayOption[] = "--relay";

/// The program was started to be the relay.
inline bool isRelay(int argc, char** argv) {
  return argc > 2 && std::strcmp(argv[1], kRelayOption) == 0;
}

/// @return exit code
inline int relayMain(int argc, char** argv) {
  int no_arguments = 0;
  ros::init(no_arguments, nullptr, "relay");
  ros::NodeHandle nh(std::string("/") + argv[2]);
  const ros::Publisher publisher = nh.advertise<geometry_msgs::PoseStamped>("servo_cp", 1);
  const ros::Subscriber subscriber = nh.subscribe<geometry_msgs::PoseStamped>(
      "desired/servo_cp", 1,
      [&](const geometry_msgs::PoseStamped::ConstPtr& message) { publisher.publish(message); },
      ros::VoidConstPtr(), ros::TransportHints().tcpNoDelay());
  // As the node corrector does it, so that the two differ by the correction alone.
  if (const int priority = argc > 3 ? std::atoi(argv[3]) : 0) {
    for (const std::string& refusal :
         {takeRealtimePriority(priority), giveSocketsRealtimePriority(priority)})
      if (!refusal.empty()) ROS_WARN("relay: %s", refusal.c_str());
  }
  ros::spin();
  return 0;
}

/// @param priority  real-time; 0: none
inline pid_t startRelay(OwnMaster& master, const std::string& ns, int priority) {
  return master.start("relay", {std::filesystem::read_symlink("/proc/self/exe").string(),
                                kRelayOption, ns, std::to_string(priority)});
}

}  // namespace bench
}  // namespace raven_correction
