// SPDX-License-Identifier: BSD-3-Clause
#include "plant/hidden_effect.h"

#include <algorithm>
#include <cmath>
#include <random>

#include "raven_correction/error.h"
#include "raven_correction/robot/gravity_load.h"

namespace raven_correction::plant {
namespace {

constexpr double kStallForce = 2000.0;  // of a motor with a speed limit, far above its loads [Nm]
constexpr double kStretchDrag = 3e-4;   // b / k_c of a soft cable: its lag behind the motor [s]
constexpr double kStretchFriction = 0.04;  // share of the link's friction that a soft cable leaves

/// Parameters by symbol; complains about what is missing or unknown.
class Symbols {
 public:
  explicit Symbols(const HiddenEffect& effect) : effect_(effect), left_(effect.parameters) {}

  double required(const char* symbol) {
    const auto found = left_.find(symbol);
    if (found == left_.end())
      throw InvalidInput(
          format("hidden effect %s needs the parameter %s", effect_.effect.c_str(), symbol));
    return take(found);
  }
  double optional(const char* symbol, double otherwise) {
    const auto found = left_.find(symbol);
    return found == left_.end() ? otherwise : take(found);
  }
  Pose pose() {
    const Eigen::Vector3d p(optional("x", 0.0), optional("y", 0.0), optional("z", 0.0));
    const Eigen::Vector3d r(optional("rx", 0.0), optional("ry", 0.0), optional("rz", 0.0));
    return {p, expRotation(r)};
  }
  void refuseOthers() const {
    if (!left_.empty())
      throw InvalidInput(format("hidden effect %s has no parameter %s", effect_.effect.c_str(),
                                left_.begin()->first.c_str()));
  }

 private:
  double take(std::map<std::string, double>::iterator found) {
    const double value = found->second;
    if (!std::isfinite(value))
      throw InvalidInput(format("hidden effect %s: %s is not finite", effect_.effect.c_str(),
                                found->first.c_str()));
    left_.erase(found);
    return value;
  }
  const HiddenEffect& effect_;
  std::map<std::string, double> left_;
};

/// Largest load on a joint in the middle half of the robot's range [Nm or N].
double largestLoad(const KinematicChain& chain, int joint) {
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> share(0.25, 0.75);
  double largest = 0.0;
  for (int k = 0; k < 100; ++k) {
    JointVector q(chain.size());
    for (int j = 0; j < chain.size(); ++j)
      q(j) = chain.lower()(j) + share(random) * (chain.upper()(j) - chain.lower()(j));
    largest = std::max(largest, std::abs(gravityLoad(chain, q, 0.0)(joint)));
  }
  return largest;
}

void changeLink(Symbols& symbols, std::size_t row, RobotPhysics& physics) {
  const KinematicChain& chain = physics.chain;
  std::vector<Joint> joints = chain.joints();
  joints[row].alpha += symbols.optional("alpha", 0.0);
  joints[row].a += symbols.optional("a", 0.0);
  joints[row].d_offset += symbols.optional("d", 0.0);
  KinematicChain real(chain.name(), chain.frame(), chain.baseTransform(), std::move(joints),
                      chain.toolTransform());
  real.setGravity(chain.gravity());
  physics.chain = real;
}

void addBacklash(Symbols& symbols, int row, RobotPhysics& physics, JointPhysics& joint) {
  const double width = symbols.required("w");
  const double sharpness = symbols.optional("n", 0.0);
  if (sharpness > 0.0) {
    joint.hysteresis_width = width;
    joint.hysteresis_sharpness = sharpness;
    return;
  }
  joint.play = width;
  joint.joint_friction += 2.0 * largestLoad(physics.chain, row);
}

void soften(double stretch_per_load, JointPhysics& joint) {
  if (!(stretch_per_load > 0.0)) return;
  joint.cable_stiffness = 1.0 / stretch_per_load;
  joint.cable_damping = 2.0 * std::sqrt(joint.cable_stiffness * joint.link_inertia);
  joint.joint_viscous = std::min(joint.joint_viscous, kStretchDrag * joint.cable_stiffness);
  joint.joint_friction *= kStretchFriction;
}

void applyToJoint(const std::string& name, Symbols& symbols, int row, RobotPhysics& physics) {
  JointPhysics& joint = physics.joints[static_cast<std::size_t>(row)];
  if (name == "tracking_lag") {
    joint.damping = std::max(0.0, symbols.required("T") * joint.stiffness - joint.joint_viscous);
  } else if (name == "drive_friction") {
    joint.motor_friction = 0.5 * symbols.required("w") * joint.stiffness;
  } else if (name == "speed_limit") {
    joint.no_load_speed = symbols.required("v");
    joint.stall_force = kStallForce;
  } else if (name == "joint_offset") {
    joint.homing_error += symbols.required("d");
  } else if (name == "joint_gain") {
    joint.radius_error += symbols.required("g");
  } else if (name == "backlash") {
    addBacklash(symbols, row, physics, joint);
  } else if (name == "cable_stretch") {
    soften(symbols.required("s"), joint);
  } else if (name == "pulley_eccentricity") {
    joint.ripple = symbols.required("A");
    joint.ripple_number = symbols.required("N");
    joint.ripple_phase = symbols.required("phi");
  } else if (name == "creep") {
    joint.creep = symbols.required("a");
    joint.creep_time = symbols.required("T");
  } else {  // link_geometry
    changeLink(symbols, static_cast<std::size_t>(row), physics);
  }
}

const std::vector<std::string>& jointEffects() {
  static const std::vector<std::string> names{
      "tracking_lag", "drive_friction", "speed_limit",         "joint_offset", "joint_gain",
      "backlash",     "cable_stretch",  "pulley_eccentricity", "creep",        "link_geometry"};
  return names;
}

void checkJoints(const HiddenEffect& effect, int robot_joints) {
  std::size_t wanted = isJointEffect(effect.effect) ? 1 : 0;
  if (effect.effect == "joint_coupling") wanted = 2;
  if (effect.joints.size() != wanted)
    throw InvalidInput(format("hidden effect %s needs %zu joints, %zu are given",
                              effect.effect.c_str(), wanted, effect.joints.size()));
  for (const int row : effect.joints)
    if (row < 0 || row >= robot_joints)
      throw InvalidInput(format("hidden effect %s: joint %d, the robot has 0..%d",
                                effect.effect.c_str(), row, robot_joints - 1));
  if (wanted == 2 && effect.joints[0] == effect.joints[1])
    throw InvalidInput("hidden effect joint_coupling: a joint is not coupled to itself");
}

}  // namespace

std::string describe(const HiddenEffect& effect) {
  std::string text = effect.effect;
  for (const int row : effect.joints) text += format("[%d]", row);
  for (const auto& [symbol, value] : effect.parameters)
    text += format(" %s=%.5g", symbol.c_str(), value);
  return text + format(" (%.2f mm, %.2f deg)", effect.size_mm, effect.size_deg);
}

const std::vector<std::string>& hiddenEffects() {
  static const std::vector<std::string> names{
      "command_delay",       "tracking_lag", "drive_friction",
      "speed_limit",         "joint_offset", "joint_gain",
      "joint_coupling",      "backlash",     "cable_stretch",
      "pulley_eccentricity", "creep",        "link_geometry",
      "base_registration",   "tool_offset",  "registration_shift",
      "mocap_scale"};
  return names;
}

bool isJointEffect(const std::string& effect) {
  const std::vector<std::string>& names = jointEffects();
  return std::find(names.begin(), names.end(), effect) != names.end();
}

void applyEffect(const HiddenEffect& effect, RobotPhysics& physics) {
  const std::vector<std::string>& names = hiddenEffects();
  if (std::find(names.begin(), names.end(), effect.effect) == names.end())
    throw InvalidInput("the plant cannot hide an effect named " + effect.effect);
  checkJoints(effect, physics.nominal.size());
  Symbols symbols(effect);
  if (effect.effect == "command_delay") {
    physics.delay += symbols.required("tau");
  } else if (effect.effect == "joint_coupling") {
    physics.coupling(effect.joints[0], effect.joints[1]) += symbols.required("c");
  } else if (effect.effect == "base_registration") {
    physics.X_base_robot = physics.X_base_robot * symbols.pose();
  } else if (effect.effect == "tool_offset") {
    physics.X_tool_markers = physics.X_tool_markers * symbols.pose();
  } else if (effect.effect == "registration_shift") {
    physics.bump_time = symbols.required("t0");
    physics.bump = symbols.pose();
  } else if (effect.effect == "mocap_scale") {
    physics.mocap_scale += symbols.required("s");
  } else {
    applyToJoint(effect.effect, symbols, effect.joints[0], physics);
  }
  symbols.refuseOthers();
}

HiddenEffect plausible(const HiddenEffect& effect, const KinematicChain& robot) {
  if (effect.joints.empty() && effect.effect != "command_delay") return effect;
  const auto isRevolute = [&](int row) {
    return robot.joints()[static_cast<std::size_t>(row)].type == JointType::kRevolute;
  };
  const bool revolute = effect.joints.empty() || isRevolute(effect.joints[0]);
  std::map<std::string, double> limits{{"tau", 0.3},
                                       {"g", 0.3},
                                       {"w", revolute ? 0.25 : 0.01},
                                       {"d", revolute ? 0.3 : 0.02},
                                       {"A", revolute ? 0.1 : 0.005}};
  if (effect.effect == "tracking_lag") limits["T"] = 0.3;
  if (effect.effect == "creep") limits["a"] = revolute ? 0.3 : 0.02;
  if (effect.effect == "link_geometry") limits = {{"alpha", 0.2}, {"a", 0.02}, {"d", 0.02}};
  if (effect.effect == "joint_coupling") {
    const bool source_revolute = isRevolute(effect.joints[1]);
    limits = {{"c", revolute == source_revolute ? 0.3 : revolute ? 6.0 : 0.015}};
  }
  HiddenEffect result = effect;
  for (auto& [symbol, value] : result.parameters) {
    const auto limit = limits.find(symbol);
    if (limit != limits.end()) value = std::clamp(value, -limit->second, limit->second);
  }
  return result;
}

HiddenEffect scaled(const HiddenEffect& effect, double factor) {
  HiddenEffect result = effect;
  for (auto& [symbol, value] : result.parameters) {
    const bool is_place = symbol == "N" || symbol == "phi" || symbol == "t0" || symbol == "n" ||
                          (symbol == "T" && effect.effect == "creep");
    if (symbol == "v")
      value /= factor;
    else if (!is_place)
      value *= factor;
  }
  return result;
}

}  // namespace raven_correction::plant
