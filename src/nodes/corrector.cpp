// SPDX-License-Identifier: BSD-3-Clause
// Rewrites desired poses into commands that bring the tool there (ros/corrector_node.h).
#include <ros/ros.h>

#include "raven_correction/ros/corrector_node.h"
#include "raven_correction/ros/realtime.h"

int main(int argc, char** argv) {
  ros::init(argc, argv, "corrector");
  const ros::NodeHandle nh, private_nh("~");  // without one, roscpp says nothing any more
  try {
    raven_correction::CorrectorNode node(nh, private_nh);
    // This process is there for nothing else: also what reads and writes the poses goes first.
    if (const int priority = node.realtimePriority(); priority > 0) {
      const std::string refusal = raven_correction::giveSocketsRealtimePriority(priority);
      if (!refusal.empty()) ROS_WARN("corrector: sockets: %s", refusal.c_str());
    }
    ros::spin();
  } catch (const std::exception& error) {
    ROS_FATAL("%s", error.what());
    return 1;
  }
  return 0;
}
