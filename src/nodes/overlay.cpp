// SPDX-License-Identifier: BSD-3-Clause
// Node `overlay`: load, build, spin. Everything it does is ros/overlay.h.
#include "raven_correction/ros/overlay.h"

#include <ros/ros.h>

#include "raven_correction/error.h"

int main(int argc, char** argv) {
  ros::init(argc, argv, "overlay");
  const ros::NodeHandle private_nh("~");
  try {
    const raven_correction::Overlay overlay(ros::NodeHandle(),
                                            raven_correction::loadOverlayParams(private_nh));
    ros::spin();
  } catch (const raven_correction::InvalidInput& e) {
    ROS_FATAL("%s", e.what());
    return 1;
  }
  return 0;
}
