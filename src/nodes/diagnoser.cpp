// SPDX-License-Identifier: BSD-3-Clause
// Names the physical causes of what a simulation gets wrong about recorded sessions
// (ros/diagnoser_node.h).
#include <ros/ros.h>

#include "raven_correction/ros/diagnoser_node.h"

int main(int argc, char** argv) {
  ros::init(argc, argv, "diagnoser");
  try {
    raven_correction::DiagnoserNode node(ros::NodeHandle(), ros::NodeHandle("~"));
    ros::AsyncSpinner spinner(
        3);  // one may wait for a diagnosis, one for the end of a cancelled one
    spinner.start();
    ros::waitForShutdown();
  } catch (const std::exception& error) {
    ROS_FATAL("%s", error.what());
    return 1;
  }
  return 0;
}
