// SPDX-License-Identifier: BSD-3-Clause
// Node `fragment_detector`: load, build, spin. Everything it does is ros/fragment_detector_node.h.
#include <ros/ros.h>

#include "raven_correction/error.h"
#include "raven_correction/ros/fragment_detector_node.h"

int main(int argc, char** argv) {
  ros::init(argc, argv, "fragment_detector");
  const ros::NodeHandle private_nh("~");
  try {
    const raven_correction::FragmentDetectorNode node(
        ros::NodeHandle(), private_nh, raven_correction::loadFragmentDetectorParams(private_nh));
    ros::spin();
  } catch (const raven_correction::InvalidInput& error) {
    ROS_FATAL("%s", error.what());
    return 1;
  }
  return 0;
}
