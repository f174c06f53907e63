// SPDX-License-Identifier: BSD-3-Clause
// Simulation files: shipped ones load, a saved one is the same simulation, a bad one is refused
// with everything that is wrong in it; parameters as a flat vector.
#include "raven_correction/simulation/simulation_config.h"

#include <dirent.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <fstream>

#include "raven_correction/error.h"
#include "raven_correction/simulation/effect_registry.h"
#include "simulation/simulations.h"

namespace raven_correction {
namespace {

std::vector<std::string> shippedFiles() {
  std::vector<std::string> files;
  DIR* folder = opendir("config/simulation");
  while (const dirent* entry = readdir(folder)) {
    const std::string name = entry->d_name;
    if (name.size() > 5 && name.substr(name.size() - 5) == ".yaml")
      files.push_back("config/simulation/" + name);
  }
  closedir(folder);
  return files;
}

TEST(SimulationConfig, EveryShippedFileLoads) {
  const std::vector<std::string> files = shippedFiles();
  EXPECT_GE(files.size(), 2u);
  for (const std::string& file : files) {
    const SimulationConfig config = loadSimulationConfig(file);
    EXPECT_EQ("config/simulation/" + config.name + ".yaml", file);
    EXPECT_NO_THROW(DebridementMotion(config.debridement, config.robot, 1)) << file;
  }
}

TEST(SimulationConfig, EveryEffectHasAnExample) {
  for (const std::string& name : effectNames()) {
    const SimulationConfig config = shippedSimulation("effect_" + name);
    ASSERT_EQ(config.effects.size(), 1u) << name;
    EXPECT_EQ(config.effects[0]->name(), name);
    EXPECT_FALSE(parameterVector(config).isZero());
  }
}

TEST(SimulationConfig, SavedFileIsTheSameSimulation) {
  const std::string path = testing::TempDir() + "raven_correction_simulation.yaml";
  for (const std::string& file : shippedFiles()) {
    SimulationConfig config = loadSimulationConfig(file);
    if (!config.effects.empty()) {
      std::unique_ptr<Effect> effect = config.effects[0]->clone();
      effect->setValue(0, effect->parameters()[0].upper / 3.0);
      effect->setDeviation(0, 1.0 / 7.0);
      config.set(std::move(effect));
    }
    saveSimulationConfig(config, path);
    const SimulationConfig back = loadSimulationConfig(path);
    EXPECT_EQ(back.name, config.name);
    EXPECT_EQ(back.description, config.description);
    ASSERT_EQ(back.effects.size(), config.effects.size());
    ASSERT_EQ(parameterLabels(back), parameterLabels(config));
    EXPECT_TRUE(parameterVector(back) == parameterVector(config));
    if (!config.effects.empty()) {
      EXPECT_EQ(back.effects[0]->parameters()[0].deviation, 1.0 / 7.0);
    }
    for (const MotionCaptureField& field : motionCaptureFields())
      EXPECT_EQ(back.motion_capture.*field.value, config.motion_capture.*field.value);
    for (const GripperField& field : gripperFields())
      EXPECT_EQ(back.gripper.*field.value, config.gripper.*field.value);
    for (const DebridementField& field : debridementFields())
      EXPECT_EQ(back.debridement.*field.value, config.debridement.*field.value);
    EXPECT_EQ(back.debridement.field_centre, config.debridement.field_centre);
  }
  std::remove(path.c_str());
}

TEST(SimulationConfig, ParametersAsAVector) {
  const SimulationConfig config = shippedSimulation("raven2_left_case2014");
  const Eigen::VectorXd values = parameterVector(config);
  const std::vector<std::string> labels = parameterLabels(config);
  ASSERT_EQ(static_cast<std::size_t>(values.size()), labels.size());
  EXPECT_EQ(labels[0], "command_delay.tau");
  const SimulationConfig changed = withParameters(config, 0.5 * values);
  EXPECT_TRUE(parameterVector(changed) == 0.5 * values);
  EXPECT_TRUE(parameterVector(config) == values) << "the original is not touched";
  EXPECT_THROW(withParameters(config, values.head(3)), InvalidInput);
  Eigen::VectorXd bad = values;
  bad(0) = std::nan("");
  EXPECT_THROW(withParameters(config, bad), InvalidInput);
}

TEST(SimulationConfig, EffectsStandInActingOrder) {
  SimulationConfig config = shippedSimulation("nominal");
  for (const char* name : {"backlash", "base_registration", "command_delay", "tracking_lag"})
    config.set(makeEffect(name, config.robot));
  for (std::size_t i = 1; i < config.effects.size(); ++i) {
    EXPECT_LT(effectRank(config.effects[i - 1]->name()), effectRank(config.effects[i]->name()));
    EXPECT_LE(config.effects[i - 1]->stage(), config.effects[i]->stage());
  }
  config.remove("backlash");
  EXPECT_EQ(config.find("backlash"), nullptr);
}

std::string messageOf(const std::string& yaml) {
  const std::string path = testing::TempDir() + "raven_correction_bad.yaml";
  std::ofstream(path) << yaml;
  std::string message;
  try {
    loadSimulationConfig(path);
  } catch (const InvalidInput& error) {
    message = error.what();
  }
  std::remove(path.c_str());
  return message;
}

TEST(SimulationConfig, ListsEverythingThatIsWrong) {
  const std::string message = messageOf(
      "robot: raven2_left.yaml\n"
      "stp: 0.001\n"
      "effects:\n"
      "  - effect: bakclash\n"
      "  - effect: backlash\n"
      "    w: {elbow: 7.0, knee: 0.1}\n"
      "  - effect: command_delay\n"
      "    tau: late\n"
      "  - effect: joint_coupling\n"
      "    c: {elbow: {elbow: 0.1, toe: 0.2}}\n"
      "  - effect: joint_gain\n"
      "    g: 0.1\n"
      "  - effect: creep\n"
      "    b: {elbow: 0.1}\n"
      "  - effect: backlash\n"
      "motion_capture: {rate: 0}\n"
      "gripper: {lower: 1.0, upper: 0.5, payload: heavy, grasp_opening: -0.3, weight: 1}\n"
      "debridement: {orientation: [0, 0, 0, 2]}\n");
  for (const char* expected :
       {"name: missing", "stp: unknown key; did you mean step?", "\"bakclash\" is not one of:",
        "effects[1].w.elbow: 7 is outside [0, 0.5]", "effects[1].w.knee: raven2_left has no such",
        "effects[2].tau: \"late\" is not a number", "effects[3].c.elbow.elbow: a joint is not",
        "effects[3].c.elbow.toe: raven2_left has no such", "effects[4].g: must be a mapping",
        "effects[5].b: unknown key", "effects[6].effect: backlash is listed twice",
        "motion_capture.rate: 0 is outside", "debridement.orientation",
        "gripper.lower: 1 is above upper, 0.5", "gripper.payload: \"heavy\" is not a number",
        "gripper.grasp_opening: -0.3 is not between", "gripper.weight: unknown key"})
    EXPECT_NE(message.find(expected), std::string::npos) << expected << "\n" << message;
}

TEST(SimulationConfig, NamesAMissingRobot) {
  const std::string message = messageOf("name: x\nrobot: raven9.yaml\n");
  EXPECT_NE(message.find("robot: no file raven9.yaml"), std::string::npos) << message;
}

}  // namespace
}  // namespace raven_correction
