// SPDX-License-Identifier: BSD-3-Clause
// Node `field_camera`: load, build, spin. Everything it does is ros/field_camera_node.h.
#include <ros/ros.h>

#include "raven_correction/error.h"
#include "raven_correction/ros/field_camera_node.h"

int main(int argc, char** argv) {
  ros::init(argc, argv, "field_camera");
  const ros::NodeHandle private_nh("~");
  try {
    const raven_correction::FieldCameraNode node(
        ros::NodeHandle(), private_nh, raven_correction::loadFieldCameraParams(private_nh));
    ros::spin();
  } catch (const raven_correction::InvalidInput& error) {
    ROS_FATAL("%s", error.what());
    return 1;
  }
  return 0;
}
