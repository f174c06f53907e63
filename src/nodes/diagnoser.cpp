// SPDX-License-Identifier: BSD-3-Clause
// Names the physical causes of what a simulation gets wrong about recorded sessions
// (ros/diagnoser_node.h).
#include <ros/ros.h>

#include "raven_correction/ros/diagnoser_node.h"

int main(int argc, char** argv) {
  ros::init(argc, argv, "diagnoser");
  try {
    raven_correction::DiagnoserNode node(ros::NodeHandle(), ros::NodeHandle("~"));
    ros::AsyncSpinner spinner(2);  // one may wait for a diagnosis; the other says that one runs
    spinner.start();
    ros::waitForShutdown();
  } catch (const std::exception& error) {
    ROS_FATAL("%s", error.what());
    return 1;
  }
  return 0;
}
