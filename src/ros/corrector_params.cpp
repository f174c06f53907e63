// SPDX-License-Identifier: BSD-3-Clause
#include "raven_correction/ros/corrector_params.h"

#include <ros/console.h>

#include <algorithm>
#include <set>

#include "raven_correction/error.h"
#include "raven_correction/ros/names.h"
#include "raven_correction/ros/params.h"
#include "raven_correction/ros/pose_command.h"
#include "raven_correction/ros/pose_subscription.h"
#include "raven_correction/ros/realtime.h"

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

void readPreflight(ParamReader& read, CorrectorParams& params) {
  read.flag("require_preflight", params.require_preflight);
  read.positive("preflight_duration", params.preflight_duration, 600.0);
  read.integer("preflight_poses", params.preflight_poses, 10, 100000);
  read.positive("preflight_factor", params.preflight.factor, 100.0);
  read.positive("preflight_max_position", params.preflight.max_position, 0.1);
  read.positive("preflight_max_angle", params.preflight.max_angle, 3.1416);
  params.preflight.min_poses =
      std::min<std::size_t>(params.preflight.min_poses,
                            static_cast<std::size_t>(std::max(1, params.preflight_poses / 5)));
  std::vector<std::string> types = poseTypes();
  types.insert(types.begin(), "same");
  params.mocap_pose_type = "same";
  read.oneOf("mocap_pose_type", params.mocap_pose_type, types);
  if (params.mocap_pose_type == "same")
    params.mocap_pose_type = params.pose_type == kRavenCommand ? "PoseStamped" : params.pose_type;
  read.text("mocap_frame", params.mocap_frame);
  read.oneOf("mocap_stamp", params.mocap_stamp, {"header", "receipt"});
  if (params.require_preflight && params.enabled)
    read.problem("enabled",
                 "is true, and so is ~require_preflight: at the start no model has passed a "
                 "pre-flight; leave one of them out");
}

/// @param ns  below that of the node; empty: the same
void readArm(ParamReader& read, const std::string& ns, CorrectedArmParams& arm) {
  const std::string prefix = ns.empty() ? "" : ns + "/";
  read.text(prefix + "arm", arm.arm);
  read.text(prefix + "tool", arm.tool);
  read.text(prefix + "model", arm.model);
  read.text(prefix + "robot", arm.robot);
  arm.model = expandHome(arm.model);
  arm.robot = expandHome(arm.robot);
}

/// The arms of a RavenCommand by the names and namespaces that were given; none where they are
/// wrong.
std::vector<CorrectedArmParams> namedArms(ParamReader& read, const std::vector<std::string>& names,
                                          std::vector<std::string> namespaces) {
  if (names.empty() || names.size() > kMaxCorrectedArms) {
    read.problem("arms", format("has %zu names, must be 1 to %zu: those that pose_type %s uses, "
                                "e.g. [L, R]",
                                names.size(), kMaxCorrectedArms, kRavenCommand));
    return {};
  }
  if (namespaces.empty() && names.size() > 1) namespaces = names;
  if (namespaces.empty()) namespaces.resize(1);
  if (namespaces.size() != names.size()) {
    read.problem("arm_namespaces", format("has %zu entries for %zu ~arms; give one for each",
                                          namespaces.size(), names.size()));
    return {};
  }
  const auto hasTwice = [](const std::vector<std::string>& texts) {
    return std::set<std::string>(texts.begin(), texts.end()).size() != texts.size();
  };
  if (hasTwice(names)) read.problem("arms", "has a name twice");
  if (hasTwice(namespaces)) read.problem("arm_namespaces", "has an entry twice");
  if (hasTwice(names) || hasTwice(namespaces)) return {};
  std::vector<CorrectedArmParams> arms(names.size());
  for (std::size_t i = 0; i < names.size(); ++i) {
    arms[i].name = names[i];
    arms[i].ns = namespaces[i];
  }
  return arms;
}

/// What is set for the node is that of its only arm; of two, each has its own.
void readArms(ParamReader& read, std::vector<CorrectedArmParams>& arms) {
  CorrectedArmParams common;
  readArm(read, "", common);
  if (arms.size() > 1) {
    const std::pair<std::string, const std::string*> values[] = {{"arm", &common.arm},
                                                                 {"tool", &common.tool},
                                                                 {"model", &common.model},
                                                                 {"robot", &common.robot}};
    for (const auto& [name, value] : values)
      if (!value->empty())
        read.problem(name, "is set for both arms; set ~" + arms[0].ns + "/" + name + " and ~" +
                               arms[1].ns + "/" + name);
  }
  for (CorrectedArmParams& arm : arms) {
    if (arms.size() == 1) {
      arm.arm = common.arm;
      arm.tool = common.tool;
      arm.model = common.model;
      arm.robot = common.robot;
    }
    if (arm.ns.empty()) continue;
    readArm(read, arm.ns, arm);
    if (arms.size() > 1 && arm.arm.empty())
      read.problem(
          arm.ns + "/arm",
          "is missing: a model of one arm must not be taken for the other; e.g. raven2_left");
  }
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
  read.integer("realtime_priority", params.realtime_priority, 0, kHighestRealtimePriority);
  read.flag("lookahead", params.lookahead);
  readPreflight(read, params);

  params.arms.resize(1);
  if (params.pose_type == kRavenCommand)
    params.arms = namedArms(read, names, namespaces);
  else if (!names.empty() || !namespaces.empty())
    read.problem(
        names.empty() ? "arm_namespaces" : "arms",
        "is for pose_type RavenCommand only; other messages carry one pose, and an arm is a "
        "namespace");
  readArms(read, params.arms);
  std::vector<std::string> known_namespaces{"diagnostic_period"};
  if (params.arms.empty()) {  // what is below them is no problem by itself
    known_namespaces.insert(known_namespaces.end(), names.begin(), names.end());
    known_namespaces.insert(known_namespaces.end(), namespaces.begin(), namespaces.end());
  }
  read.refuseUnknownKeys(known_namespaces);
  read.throwIfAnyProblem();
  params.base_frame = withoutSlash(params.base_frame);
  ROS_INFO("%s", read.summary().c_str());
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
  const struct {
    const char* name;
    const std::string &of_model, &here;
  } required[] = {{"arm", model.arm, arm.arm}, {"tool", model.tool, arm.tool}};
  for (const auto& field : required) {
    compare(field.name, field.of_model, field.here, field.name);
    if (!field.here.empty() && field.of_model.empty())
      refuse(
          format("does not say for which %s it is, and ~%s asks for \"%s\"; train it with the "
                 "trainer's ~%s set",
                 field.name, field.name, field.here.c_str(), field.name));
  }
  compare("message type", model.pose_type, params.pose_type, "pose_type");
  if (model.expires_at > 0.0 && now > model.expires_at)
    refuse(
        format("has expired %.1f h ago; record and train again, or check it and raise the "
               "trainer's ~valid_hours",
               (now - model.expires_at) / 3600.0));
}

}  // namespace raven_correction
