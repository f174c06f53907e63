// SPDX-License-Identifier: BSD-3-Clause
#include "raven_correction/ros/corrector_params.h"

#include <ros/console.h>

#include <set>

#include "raven_correction/error.h"
#include "raven_correction/ros/names.h"
#include "raven_correction/ros/params.h"
#include "raven_correction/ros/pose_command.h"

namespace raven_correction {
namespace {

constexpr char kRavenCommand[] = "RavenCommand";

void readLimits(ParamReader& read, CorrectorLimits& limits) {
  read.positive("max_translation", limits.max_translation, 0.2);
  read.positive("max_rotation", limits.max_rotation, 3.1416);
  read.positive("max_translation_rate", limits.max_translation_rate, 10.0);
  read.positive("max_rotation_rate", limits.max_rotation_rate, 100.0);
  read.positive("max_step_time", limits.max_step_time, 1.0);
  read.number("max_age", limits.max_age, 0.0, 60.0);
  read.number("max_ahead", limits.max_ahead, 0.0, 60.0);
  std::vector<double> box_min(3, 0.0), box_max(3, 0.0);
  read.numbers("box_min", box_min, 3, -10.0, 10.0);
  read.numbers("box_max", box_max, 3, -10.0, 10.0);
  limits.box_min = {box_min[0], box_min[1], box_min[2]};
  limits.box_max = {box_max[0], box_max[1], box_max[2]};
  read.number("robot_max_step", limits.robot.max_step, 0.0, 1.0);
  read.number("robot_max_turn", limits.robot.max_turn, 0.0, 3.1416);
  read.positive("max_measured_age", limits.max_measured_age, 10.0);
}

void readArm(ParamReader& read, CorrectedArmParams& arm) {
  read.text("arm", arm.arm);
  read.text("tool", arm.tool);
  read.text("model", arm.model);
  read.text("robot", arm.robot);
}

/// The arms of a RavenCommand by the names and namespaces that were given.
std::vector<CorrectedArmParams> namedArms(const std::vector<std::string>& names,
                                          std::vector<std::string> namespaces) {
  if (names.empty() || names.size() > kMaxCorrectedArms)
    throw InvalidInput(
        format("corrector: ~arms has %zu names, must be 1 to %zu: those that pose_type %s uses, "
               "e.g. [L, R]",
               names.size(), kMaxCorrectedArms, kRavenCommand));
  if (namespaces.empty() && names.size() > 1) namespaces = names;
  if (namespaces.empty()) namespaces.resize(1);
  if (namespaces.size() != names.size())
    throw InvalidInput(format("corrector: %zu ~arms but %zu ~arm_namespaces; give one for each",
                              names.size(), namespaces.size()));
  if (std::set<std::string>(names.begin(), names.end()).size() != names.size() ||
      std::set<std::string>(namespaces.begin(), namespaces.end()).size() != names.size())
    throw InvalidInput("corrector: a name occurs twice in ~arms or in ~arm_namespaces");
  std::vector<CorrectedArmParams> arms(names.size());
  for (std::size_t i = 0; i < names.size(); ++i) {
    arms[i].name = names[i];
    arms[i].ns = namespaces[i];
  }
  return arms;
}

}  // namespace

CorrectorParams loadCorrectorParams(const ros::NodeHandle& nh) {
  CorrectorParams params;
  ParamReader read(nh, "corrector");
  read.text("base_frame", params.base_frame);
  read.flag("allow_empty_frame", params.allow_empty_frame);
  read.oneOf("pose_type", params.pose_type, commandTypes());
  std::vector<std::string> names, namespaces;
  read.texts("arms", names);
  read.texts("arm_namespaces", namespaces);
  read.oneOf("mode", params.mode, {"rigid", "full", "endpoint"});
  read.flag("enabled", params.enabled);
  read.number("gain", params.gain, 0.0, 1.0);
  readLimits(read, params.limits);
  read.text("robot_state_topic", params.robot_state_topic);
  read.positive("robot_state_timeout", params.robot_state_timeout, 60.0);
  read.flag("watch_output", params.watch_output);

  params.arms.resize(1);
  CorrectedArmParams common;
  readArm(read, common);
  if (params.pose_type == kRavenCommand)
    params.arms = namedArms(names, namespaces);
  else if (!names.empty() || !namespaces.empty())
    throw InvalidInput(
        "corrector: ~arms and ~arm_namespaces are for pose_type RavenCommand only; other messages "
        "carry one pose, and an arm is a namespace");
  std::vector<std::string> known_namespaces{"diagnostic_period"};
  std::string summaries;
  for (CorrectedArmParams& arm : params.arms) {
    const std::string name = arm.name, ns = arm.ns;
    arm = common;
    arm.name = name;
    arm.ns = ns;
    if (ns.empty()) continue;
    ParamReader read_arm(ros::NodeHandle(nh, arm.ns), "corrector: arm " + arm.name);
    readArm(read_arm, arm);
    read_arm.refuseUnknownKeys();
    read_arm.throwIfAnyProblem();
    summaries += "\n" + read_arm.summary();
    known_namespaces.push_back(arm.ns.substr(0, arm.ns.find('/')));
  }
  read.refuseUnknownKeys(known_namespaces);
  read.throwIfAnyProblem();
  params.base_frame = withoutSlash(params.base_frame);
  for (CorrectedArmParams& arm : params.arms) {
    arm.model = expandHome(arm.model);
    arm.robot = expandHome(arm.robot);
  }
  ROS_INFO("%s%s", read.summary().c_str(), summaries.c_str());
  return params;
}

void checkModelIsFor(const Correction& model, const CorrectorParams& params,
                     const CorrectedArmParams& arm, double now) {
  const auto refuse = [&](const std::string& text) {
    throw InvalidInput(format("model %s %s", model.id.c_str(), text.c_str()));
  };
  const auto compare = [&](const char* what, const std::string& of_model, const std::string& here,
                           const char* parameter) {
    if (!of_model.empty() && !here.empty() && of_model != here)
      refuse(
          format("is for the %s \"%s\", this corrector is set up for \"%s\" (~%s); load a model "
                 "that was recorded there",
                 what, of_model.c_str(), here.c_str(), parameter));
  };
  if (!sameName(model.frame, params.base_frame))
    refuse(format("is for the frame \"%s\", this corrector works in \"%s\" (~base_frame)",
                  model.frame.c_str(), params.base_frame.c_str()));
  compare("arm", model.arm, arm.arm, "arm");
  compare("tool", model.tool, arm.tool, "tool");
  compare("message type", model.pose_type, params.pose_type, "pose_type");
  if (!arm.arm.empty() && model.arm.empty())
    refuse(
        format("does not say for which arm it is, and ~arm asks for \"%s\"; train it with the "
               "trainer's ~arm set",
               arm.arm.c_str()));
  if (model.expires_at > 0.0 && now > model.expires_at)
    refuse(
        format("has expired %.1f h ago; record and train again, or check it and raise the "
               "trainer's ~valid_hours",
               (now - model.expires_at) / 3600.0));
}

}  // namespace raven_correction
