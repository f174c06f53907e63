// SPDX-License-Identifier: BSD-3-Clause
// The node `planner`: random motions over a field of fragments. What it does is in
// ros/planner_node.h, its parameters are in config/planner.yaml.
#include "raven_correction/error.h"
#include "raven_correction/ros/planner_node.h"

int main(int argc, char** argv) {
  ros::init(argc, argv, "planner");
  ros::NodeHandle nh;
  ros::NodeHandle private_nh("~");
  try {
    raven_correction::PlannerNode node(nh, private_nh,
                                       raven_correction::loadPlannerParams(private_nh));
    ros::AsyncSpinner spinner(raven_correction::PlannerNode::kThreads);
    spinner.start();
    ros::waitForShutdown();
  } catch (const raven_correction::InvalidInput& error) {
    ROS_FATAL("%s", error.what());
    return 1;
  }
  return 0;
}
