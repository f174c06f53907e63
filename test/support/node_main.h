// SPDX-License-Identifier: BSD-3-Clause
// main() of a node's test: one node for all its tests, and what they wrote goes when all passed.
#pragma once

#include <gtest/gtest.h>
#include <ros/ros.h>

#include <filesystem>
#include <string>

namespace raven_correction {

/// @return exit code of the test. The folder that the parameter /directory names is removed only if
///         it is one that roslaunch's $(anon raven_correction_...) made in /tmp.
inline int runNodeTests(int argc, char** argv, const char* node) {
  testing::InitGoogleTest(&argc, argv);
  ros::init(argc, argv, node);
  const ros::NodeHandle keep;
  const int result = RUN_ALL_TESTS();
  std::string directory;
  if (result == 0 && ros::param::get("/directory", directory) &&
      directory.rfind("/tmp/raven_correction_", 0) == 0)
    std::filesystem::remove_all(directory);
  return result;
}

}  // namespace raven_correction
