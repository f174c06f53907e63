// SPDX-License-Identifier: BSD-3-Clause
#include "raven_correction/ros/arm_kinematics.h"

#include <map>

#include "raven_correction/error.h"
#include "raven_correction/robot/chain_file.h"
#include "raven_correction/ros/names.h"

namespace raven_correction {
namespace {

/// The name that config/robots has for a joint.
std::string plainName(std::string name) {
  for (const std::string prefix : {"gold_", "green_"})
    if (name.compare(0, prefix.size(), prefix) == 0) name.erase(0, prefix.size());
  for (const std::string suffix : {"_L", "_R"})
    if (name.size() > suffix.size() &&
        name.compare(name.size() - suffix.size(), suffix.size(), suffix) == 0)
      name.erase(name.size() - suffix.size());
  static const std::map<std::string, std::string> kNames{{"ins", "insertion"},
                                                         {"roll", "tool_roll"},
                                                         {"wrist", "wrist_pitch"},
                                                         {"wrist_joint", "wrist_pitch"},
                                                         {"jaw1", "finger_1"},
                                                         {"jaw2", "finger_2"},
                                                         {"grasper_joint_1", "finger_1"},
                                                         {"grasper_joint_2", "finger_2"},
                                                         {"grasper_yaw", "wrist_yaw"}};
  const auto known = kNames.find(name);
  return known == kNames.end() ? name : known->second;
}

}  // namespace

std::optional<JointVector> jointsOfChain(const KinematicChain& chain,
                                         const std::vector<std::string>& names,
                                         const Eigen::VectorXd& positions) {
  if (positions.size() != static_cast<Eigen::Index>(names.size())) return std::nullopt;
  std::map<std::string, double> by_name;
  for (std::size_t i = 0; i < names.size(); ++i) {
    by_name.emplace(names[i], positions(static_cast<Eigen::Index>(i)));
    by_name.emplace(plainName(names[i]), positions(static_cast<Eigen::Index>(i)));
  }
  if (by_name.count("finger_1") > 0 && by_name.count("finger_2") > 0)
    by_name.emplace("wrist_yaw", 0.5 * (by_name["finger_2"] - by_name["finger_1"]));
  JointVector joints(chain.size());
  for (int k = 0; k < chain.size(); ++k) {
    const auto found = by_name.find(chain.joints()[static_cast<std::size_t>(k)].name);
    if (found == by_name.end()) return std::nullopt;
    joints(k) = found->second;
  }
  return joints;
}

std::vector<ArmKinematics> loadArms(const std::string& robot,
                                    const std::vector<std::string>& others,
                                    const std::string& base_frame) {
  std::vector<ArmKinematics> arms;
  if (robot.empty()) return arms;
  std::vector<std::string> files{robot};
  files.insert(files.end(), others.begin(), others.end());
  for (const std::string& file : files) {
    const KinematicChain chain = loadKinematicChain(expandHome(file));
    if (!base_frame.empty() && !sameName(chain.frame(), base_frame))
      throw InvalidInput(format("%s is a robot in the frame \"%s\", poses are in \"%s\"",
                                file.c_str(), chain.frame().c_str(), base_frame.c_str()));
    arms.push_back({chain.name(), [chain](const std::vector<std::string>& names,
                                          const Eigen::VectorXd& positions) {
                      const auto joints = jointsOfChain(chain, names, positions);
                      return joints ? std::optional<Pose>(chain.forward(*joints)) : std::nullopt;
                    }});
  }
  return arms;
}

}  // namespace raven_correction
