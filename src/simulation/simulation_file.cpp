// SPDX-License-Identifier: BSD-3-Clause
// Simulations to and from YAML. Effects are read and written through their parameter lists, so a
// new effect needs no line here.
#include <sys/stat.h>

#include <cstdio>
#include <fstream>
#include <limits>
#include <set>
#include <sstream>

#include "raven_correction/error.h"
#include "raven_correction/robot/chain_file.h"
#include "raven_correction/robot/yaml_reader.h"
#include "raven_correction/simulation/effect_registry.h"
#include "raven_correction/simulation/simulation_config.h"

namespace raven_correction {
namespace {

constexpr double kUnlimited = std::numeric_limits<double>::max();
const std::vector<std::string> kSetpointModes{"hold", "linear"};

bool isFile(const std::string& path) {
  struct stat status;
  return ::stat(path.c_str(), &status) == 0 && S_ISREG(status.st_mode);
}

std::string folderOf(const std::string& path) {
  const std::size_t slash = path.rfind('/');
  return slash == std::string::npos ? std::string(".") : path.substr(0, slash);
}

/// The robot file: as written if that is an absolute path that exists, else in ../robots/ of the
/// simulation's folder, beside the simulation, relative to the working directory, or in
/// config/robots/ there. Empty if there is none.
std::string findRobotFile(const std::string& written, const std::string& simulation_path) {
  const std::string name = written.substr(written.rfind('/') + 1);  // npos + 1 = 0
  const std::string folder = folderOf(simulation_path);
  const std::string places[] = {folder + "/../robots/" + name, folder + "/" + written, written,
                                "config/robots/" + name};
  for (const std::string& place : places) {
    if (written[0] == '/' && isFile(written)) return written;
    if (isFile(place)) return place;
  }
  return "";
}

std::string jointList(const KinematicChain& robot) {
  std::string names;
  for (const Joint& joint : robot.joints()) names += (names.empty() ? "" : ", ") + joint.name;
  return names;
}

/// The keys of `reader` that name no joint are problems.
void refuseOtherJoints(YamlReader& reader, const KinematicChain& robot) {
  for (const std::string& key : reader.keys())
    if (robot.find(key) < 0)
      reader.problem(key, robot.name() + " has no such joint; it has: " + jointList(robot));
}

/// One parameter: a number, a mapping of joints, or a mapping of joints of mappings of joints.
void readParameter(YamlReader& reader, const EffectParameter& parameter,
                   const KinematicChain& robot, double lower, double upper, double& value) {
  if (parameter.joint < 0) {
    reader.number(parameter.symbol, value, lower, upper);
    return;
  }
  const std::vector<std::string> names = robot.jointNames();
  const std::string& joint = names[static_cast<std::size_t>(parameter.joint)];
  if (!reader.isSection(parameter.symbol)) return;  // readEffect() has said so
  YamlReader joints = reader.section(parameter.symbol);
  if (parameter.source < 0) {
    joints.number(joint, value, lower, upper);
  } else if (joints.isSection(joint)) {
    YamlReader sources = joints.section(joint);
    sources.number(names[static_cast<std::size_t>(parameter.source)], value, lower, upper);
  }
}

/// What readParameter() cannot see: sections that are none, and joints that do not exist.
void checkShape(YamlReader& reader, const Effect& effect, const KinematicChain& robot) {
  std::set<std::string> seen;
  for (const EffectParameter& parameter : effect.parameters()) {
    if (parameter.joint < 0 || !seen.insert(parameter.symbol).second) continue;
    if (!reader.has(parameter.symbol)) continue;
    YamlReader joints = reader.section(parameter.symbol);
    refuseOtherJoints(joints, robot);
    if (parameter.source < 0) continue;
    for (const std::string& key : joints.keys()) {
      if (robot.find(key) < 0) continue;
      YamlReader sources = joints.section(key);
      refuseOtherJoints(sources, robot);
      if (sources.has(key))
        sources.problem(key, "a joint is not coupled to itself; see joint_gain");
    }
  }
}

std::unique_ptr<Effect> readEffect(YamlReader& reader, const KinematicChain& robot) {
  std::string name;
  reader.requiredText("effect", name);
  if (effectRank(name) < 0) {
    std::string all;
    for (const std::string& known : effectNames()) all += (all.empty() ? "" : ", ") + known;
    if (!name.empty()) reader.problem("effect", "\"" + name + "\" is not one of: " + all);
    return nullptr;
  }
  std::unique_ptr<Effect> effect = makeEffect(name, robot);
  YamlReader deviations = reader.section("deviation");
  checkShape(reader, *effect, robot);
  checkShape(deviations, *effect, robot);
  const int count = static_cast<int>(effect->parameters().size());
  for (int i = 0; i < count; ++i) {
    const EffectParameter& parameter = effect->parameters()[static_cast<std::size_t>(i)];
    double value = 0.0;
    double deviation = 0.0;
    readParameter(reader, parameter, robot, parameter.lower, parameter.upper, value);
    readParameter(deviations, parameter, robot, 0.0, kUnlimited, deviation);
    effect->setValue(i, value);
    effect->setDeviation(i, deviation);
    if (parameter.joint >= 0) {  // known keys, whether or not they were there
      if (!reader.has(parameter.symbol)) reader.section(parameter.symbol);
      if (!deviations.has(parameter.symbol)) deviations.section(parameter.symbol);
    }
  }
  reader.refuseUnknownKeys();
  deviations.refuseUnknownKeys();
  return effect;
}

void readVector(YamlReader& reader, const char* key, Eigen::Vector3d& value, double lower,
                double upper) {
  Eigen::VectorXd read = value;
  reader.numbers(key, read, lower, upper);
  value = read;
}

void readMotionCapture(YamlReader reader, MotionCaptureConfig& config) {
  for (const MotionCaptureField& field : motionCaptureFields())
    reader.number(field.key, config.*field.value, field.lower, field.upper);
  YamlReader rig = reader.section("rig");
  readVector(rig, "centre", config.rig.centre, -2.0, 2.0);
  readVector(rig, "led_direction", config.rig.led_direction, -1.0, 1.0);
  readVector(rig, "remote_centre", config.rig.remote_centre, -1.0, 1.0);
  for (const CameraRigField& field : cameraRigFields())
    rig.number(field.key, config.rig.*field.value, field.lower, field.upper);
  rig.refuseUnknownKeys();
  reader.refuseUnknownKeys();
}

void readGripper(YamlReader reader, GripperConfig& config) {
  for (const GripperField& field : gripperFields())
    reader.number(field.key, config.*field.value, field.lower, field.upper);
  if (config.lower > config.upper)
    reader.problem("lower", format("%g is above upper, %g", config.lower, config.upper));
  reader.refuseUnknownKeys();
}

void readDebridement(YamlReader reader, DebridementConfig& config) {
  readVector(reader, "field_centre", config.field_centre, -1.0, 1.0);
  readVector(reader, "field_size", config.field_size, 0.0, 0.5);
  readVector(reader, "receptacle", config.receptacle, -1.0, 1.0);
  readVector(reader, "box_lower", config.box_lower, -1.0, 1.0);
  readVector(reader, "box_upper", config.box_upper, -1.0, 1.0);
  readVector(reader, "orientation_deviation", config.orientation_deviation, 0.0, 1.0);
  Eigen::VectorXd q = config.orientation.coeffs();
  reader.numbers("orientation", q, -1.0, 1.0);
  if (!(std::abs(q.norm() - 1.0) < 1e-3))
    reader.problem("orientation", format("a quaternion of norm %g, must be 1", q.norm()));
  else
    config.orientation = Eigen::Quaterniond(q(3), q(0), q(1), q(2)).normalized();
  for (const DebridementField& field : debridementFields())
    reader.number(field.key, config.*field.value, field.lower, field.upper);
  reader.refuseUnknownKeys();
}

std::string number(double value) { return format("%.17g", value); }

std::string vectorText(const Eigen::VectorXd& values) {
  std::string text = "[";
  for (Eigen::Index i = 0; i < values.size(); ++i) text += (i > 0 ? ", " : "") + number(values(i));
  return text + "]";
}

/// The non-zero values of an effect (or their deviations) as YAML lines.
std::string parameterText(const Effect& effect, const KinematicChain& robot,
                          const std::string& indent, double EffectParameter::*member) {
  std::string text;
  std::string symbol;
  int joint = -1;
  for (const EffectParameter& parameter : effect.parameters()) {
    const double value = parameter.*member;
    if (value == 0.0) continue;
    if (parameter.joint < 0) {
      text += indent + parameter.symbol + ": " + number(value) + "\n";
      continue;
    }
    const auto& joints = robot.joints();
    const std::string& name = joints[static_cast<std::size_t>(parameter.joint)].name;
    if (parameter.symbol != symbol) text += indent + parameter.symbol + ":\n";
    if (parameter.source < 0) {
      text += indent + "  " + name + ": " + number(value) + "\n";
    } else {
      if (parameter.symbol != symbol || parameter.joint != joint)
        text += indent + "  " + name + ":\n";
      const std::string& source = joints[static_cast<std::size_t>(parameter.source)].name;
      text += indent + "    " + source + ": " + number(value) + "\n";
    }
    symbol = parameter.symbol;
    joint = parameter.joint;
  }
  return text;
}

/// Everything but the robot. @param has_robot  config.robot is there: effects can be read
SimulationConfig readSimulation(YamlReader& reader, SimulationConfig config, bool has_robot) {
  reader.requiredText("name", config.name);
  reader.text("description", config.description);
  reader.number("step", config.step, 1e-5, 0.1);
  reader.number("encoder_rate", config.encoder_rate, 1.0, 2000.0);
  reader.flag("quantise_encoders", config.quantise_encoders);
  if (config.quantise_encoders && has_robot && config.coupling.empty())
    reader.problem("quantise_encoders", "the robot file has no section transmission");
  int mode = 0;
  reader.choice("setpoints", mode, kSetpointModes);
  config.setpoints = static_cast<SetpointMode>(mode);
  reader.numberList("fitted_to", config.fitted_to);
  for (YamlReader& entry : reader.list("effects")) {
    if (!has_robot) break;  // what an effect may hold depends on the joints
    std::unique_ptr<Effect> effect = readEffect(entry, config.robot);
    if (!effect) continue;
    if (config.find(effect->name()))
      entry.problem("effect", std::string(effect->name()) + " is listed twice");
    config.set(std::move(effect));
  }
  readMotionCapture(reader.section("motion_capture"), config.motion_capture);
  readGripper(reader.section("gripper"), config.gripper);
  readDebridement(reader.section("debridement"), config.debridement);
  const double grasp = config.gripper.grasp_opening;
  if (!(config.debridement.jaw_closed < grasp && grasp <= config.debridement.jaw_open))
    reader.problem("gripper.grasp_opening",
                   format("%g is not between debridement.jaw_closed, %g, and debridement.jaw_open, "
                          "%g: nothing would ever be grasped",
                          grasp, config.debridement.jaw_closed, config.debridement.jaw_open));
  reader.refuseUnknownKeys();
  reader.throwIfAnyProblem();
  return config;
}

std::string simulationText(const SimulationConfig& config, const std::string& robot_file) {
  std::string text = "# SPDX-License-Identifier: BSD-3-Clause\n";
  text +=
      "# Written by raven_correction. Keys, units and ranges: config/simulation/nominal.yaml.\n";
  text += "name: \"" + config.name + "\"\ndescription: \"" + config.description + "\"\n";
  text += "robot: \"" + robot_file + "\"\nstep: " + number(config.step) + "\n";
  text += "encoder_rate: " + number(config.encoder_rate) +
          "\nquantise_encoders: " + (config.quantise_encoders ? "true" : "false") +
          "\nsetpoints: " + kSetpointModes[static_cast<std::size_t>(config.setpoints)] + "\n";
  if (!config.fitted_to.empty())
    text += "fitted_to: " +
            vectorText(Eigen::Map<const Eigen::VectorXd>(
                config.fitted_to.data(), static_cast<Eigen::Index>(config.fitted_to.size()))) +
            "\n";
  text += config.effects.empty() ? "effects: []\n" : "effects:\n";
  for (const auto& effect : config.effects) {
    text += std::string("  - effect: ") + effect->name() + "\n";
    text += parameterText(*effect, config.robot, "    ", &EffectParameter::value);
    const std::string deviations =
        parameterText(*effect, config.robot, "      ", &EffectParameter::deviation);
    if (!deviations.empty()) text += "    deviation:\n" + deviations;
  }
  text += "motion_capture:\n";
  for (const MotionCaptureField& field : motionCaptureFields())
    text +=
        std::string("  ") + field.key + ": " + number(config.motion_capture.*field.value) + "\n";
  const CameraRigConfig& rig = config.motion_capture.rig;
  text += "  rig:\n    centre: " + vectorText(rig.centre) +
          "\n    led_direction: " + vectorText(rig.led_direction) +
          "\n    remote_centre: " + vectorText(rig.remote_centre) + "\n";
  for (const CameraRigField& field : cameraRigFields())
    text += std::string("    ") + field.key + ": " + number(rig.*field.value) + "\n";
  text += "gripper:\n";
  for (const GripperField& field : gripperFields())
    text += std::string("  ") + field.key + ": " + number(config.gripper.*field.value) + "\n";
  const DebridementConfig& d = config.debridement;
  text += "debridement:\n  field_centre: " + vectorText(d.field_centre) +
          "\n  field_size: " + vectorText(d.field_size) +
          "\n  receptacle: " + vectorText(d.receptacle) +
          "\n  box_lower: " + vectorText(d.box_lower) +
          "\n  box_upper: " + vectorText(d.box_upper) +
          "\n  orientation: " + vectorText(d.orientation.coeffs()) +
          "\n  orientation_deviation: " + vectorText(d.orientation_deviation) + "\n";
  for (const DebridementField& field : debridementFields())
    text += std::string("  ") + field.key + ": " + number(d.*field.value) + "\n";
  return text;
}

}  // namespace

SimulationConfig loadSimulationConfig(const std::string& path) {
  YamlReader reader = YamlReader::fromFile(path);
  SimulationConfig config;
  reader.requiredText("robot", config.robot_file);
  bool has_robot = false;
  if (!config.robot_file.empty()) {
    const std::string robot_path = findRobotFile(config.robot_file, path);
    if (robot_path.empty()) {
      reader.problem("robot", "no file " + config.robot_file + " here, nor in ../robots/");
    } else {
      try {
        config.robot = loadKinematicChain(robot_path);
        config.coupling = loadCableCoupling(robot_path);
        config.robot_file = robot_path;
        has_robot = true;
      } catch (const InvalidInput& error) {
        reader.problem("robot", error.what());
      }
    }
  }
  return readSimulation(reader, std::move(config), has_robot);
}

SimulationConfig simulationFromTexts(const SimulationTexts& texts, const std::string& name) {
  YamlReader reader = YamlReader::fromText(texts.simulation, name);
  SimulationConfig config;
  reader.requiredText("robot", config.robot_file);
  config.robot = kinematicChainFromText(texts.robot, name + ", robot");
  config.coupling = cableCouplingFromText(texts.robot, name + ", robot");
  return readSimulation(reader, std::move(config), true);
}

SimulationTexts simulationTexts(const SimulationConfig& config) {
  std::ifstream file(config.robot_file);
  std::ostringstream robot;
  if (file) robot << file.rdbuf();
  if (!file)
    throw InvalidInput(format("simulation %s: its robot file %s cannot be read",
                              config.name.c_str(), config.robot_file.c_str()));
  const std::string name = config.robot_file.substr(config.robot_file.rfind('/') + 1);
  return {simulationText(config, name), robot.str()};
}

void saveSimulationConfig(const SimulationConfig& config, const std::string& path) {
  std::string robot_file = config.robot_file;
  char resolved[4096];
  if (::realpath(robot_file.c_str(), resolved) != nullptr) robot_file = resolved;
  const std::string text = simulationText(config, robot_file);
  const std::string partial = path + ".part";
  std::ofstream file(partial);
  file << text;
  file.close();
  if (!file || std::rename(partial.c_str(), path.c_str()) != 0)
    throw InvalidInput(format("%s: cannot be written", path.c_str()));
}

}  // namespace raven_correction
