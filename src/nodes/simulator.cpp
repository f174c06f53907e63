// SPDX-License-Identifier: BSD-3-Clause
// The node `simulator`: a simulated arm with its controller and its motion capture. What it does is
// in ros/simulator_node.h, its parameters are in config/simulator.yaml.
#include "raven_correction/error.h"
#include "raven_correction/ros/simulator_node.h"

int main(int argc, char** argv) {
  ros::init(argc, argv, "simulator");
  ros::NodeHandle nh;
  ros::NodeHandle private_nh("~");
  try {
    raven_correction::SimulatorNode node(nh, private_nh,
                                         raven_correction::loadSimulatorParams(private_nh));
    node.run();
  } catch (const raven_correction::InvalidInput& error) {
    ROS_FATAL("%s", error.what());
    return 1;
  }
  return 0;
}
