// SPDX-License-Identifier: BSD-3-Clause
// Node `recorder`: load, build, spin. Everything it does is ros/recorder.h.
#include "raven_correction/ros/recorder.h"

#include <ros/ros.h>

#include "raven_correction/error.h"

int main(int argc, char** argv) {
  ros::init(argc, argv, "recorder");
  const ros::NodeHandle private_nh("~");
  try {
    raven_correction::Recorder recorder(ros::NodeHandle(), private_nh,
                                        raven_correction::loadRecorderParams(private_nh));
    ros::spin();
  } catch (const raven_correction::InvalidInput& e) {
    ROS_FATAL("%s", e.what());
    return 1;
  }
  return 0;
}
