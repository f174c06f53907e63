// SPDX-License-Identifier: BSD-3-Clause
// Robot files: every shipped one loads; a bad one is refused with all that is wrong in it.
#include "raven_correction/robot/chain_file.h"

#include <gtest/gtest.h>

#include <cstdio>
#include <fstream>

#include "raven_correction/error.h"
#include "robot/robots.h"

namespace raven_correction {
namespace {

std::string messageOf(const std::string& yaml) {
  const std::string path = testing::TempDir() + "raven_correction_robot.yaml";
  std::ofstream(path) << yaml;
  std::string message;
  try {
    loadKinematicChain(path);
  } catch (const InvalidInput& error) {
    message = error.what();
  }
  std::remove(path.c_str());
  return message;
}

TEST(ChainFile, EveryShippedRobotLoads) {
  for (const std::string& name : shippedRobots()) {
    const KinematicChain chain = shippedRobot(name);
    EXPECT_EQ(chain.name(), name);
    EXPECT_EQ(chain.size(), 6);
    EXPECT_TRUE(chain.withinLimits(chain.home()));
  }
}

TEST(ChainFile, ListsEverythingThatIsWrong) {
  const std::string message = messageOf(
      "name: test\n"
      "frame: base\n"
      "bse: []\n"
      "tool: [[1,0,0,0],[0,2,0,0],[0,0,1,0],[0,0,0,1]]\n"
      "joints:\n"
      "  - {joint: a, type: linear, alpha: 90, a: x, theta_offset: 0, d_offset: 0, sign: 1,\n"
      "     lower: 1, upper: 0, home: 0}\n");
  for (const char* expected :
       {"bse: unknown key; did you mean base?", "base: missing", "tool: its 3x3 part",
        "\"linear\" is not one of: revolute, prismatic", "alpha: 90 is outside",
        "\"x\" is not a number", "upper: must be above lower"})
    EXPECT_NE(message.find(expected), std::string::npos) << expected << "\n" << message;
}

TEST(ChainFile, MissingAndMalformedFiles) {
  EXPECT_THROW(loadKinematicChain("no/such/file.yaml"), InvalidInput);
  EXPECT_NE(messageOf("a: [1,\n").find("not YAML"), std::string::npos);
  EXPECT_NE(messageOf("- 1\n").find("must be a YAML mapping"), std::string::npos);
}

}  // namespace
}  // namespace raven_correction
