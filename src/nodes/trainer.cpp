// SPDX-License-Identifier: BSD-3-Clause
// Learns corrections from recorded sessions and publishes the live one (ros/trainer_node.h).
#include <ros/ros.h>

#include "raven_correction/memory.h"
#include "raven_correction/ros/trainer_node.h"

int main(int argc, char** argv) {
  raven_correction::keepFreedMemory();
  ros::init(argc, argv, "trainer");
  const ros::NodeHandle nh, private_nh("~");  // without one, roscpp says nothing any more
  try {
    raven_correction::TrainerNode node(nh, private_nh);
    ros::AsyncSpinner spinner(3);  // one may wait for a training; the others go on answering
    spinner.start();
    ros::waitForShutdown();
  } catch (const std::exception& error) {
    ROS_FATAL("%s", error.what());
    return 1;
  }
  return 0;
}
