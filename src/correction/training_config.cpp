// SPDX-License-Identifier: BSD-3-Clause
#include "raven_correction/correction/training_config.h"

#include <fstream>
#include <sstream>

#include "raven_correction/error.h"
#include "raven_correction/robot/chain_file.h"
#include "raven_correction/robot/yaml_reader.h"

namespace raven_correction {
namespace {

const std::vector<std::string> kVelocities = {"none", "central", "causal", "past"};
const std::vector<std::string> kKernels = {"squared_exponential", "matern32", "matern52"};
const std::vector<std::string> kMeans = {"zero", "constant", "linear"};
const std::vector<std::string> kBackends = {"exact", "sparse"};
const std::vector<std::string> kGroupings = {"shared", "position_rotation", "own"};

/// A choice whose enumerators stand in the order of the names.
template <typename Enum>
void choose(YamlReader& yaml, const std::string& key, Enum& value,
            const std::vector<std::string>& names) {
  int index = static_cast<int>(value);
  yaml.choice(key, index, names);
  value = static_cast<Enum>(index);
}

void count(YamlReader& yaml, const std::string& key, int& value, int lower, int upper) {
  double number = value;
  yaml.number(key, number, lower, upper);
  value = static_cast<int>(number);
}

std::vector<std::vector<int>> groupsOf(int grouping) {
  if (grouping == 0) return {{0, 1, 2, 3, 4, 5}};
  if (grouping == 1) return {{0, 1, 2}, {3, 4, 5}};
  return {{0}, {1}, {2}, {3}, {4}, {5}};
}

/// A file that a configuration names: beside the configuration, else as it is.
std::string besideConfiguration(const std::string& file, const std::string& named) {
  const std::string beside = file.substr(0, file.rfind('/') + 1) + named;  // npos + 1 = 0
  return named[0] != '/' && std::ifstream(beside).good() ? beside : named;
}

std::string textOf(const std::string& file) {
  std::ifstream stream(file);
  std::ostringstream text;
  text << stream.rdbuf();
  return text.str();
}

void readMotion(YamlReader yaml, const std::string& file, MotionOptions& motion) {
  choose(yaml, "velocity", motion.velocity, kVelocities);
  yaml.number("window", motion.window, 1e-3, 10.0);
  yaml.numberList("intervals", motion.intervals, 1e-3, 10.0);
  yaml.number("max_gap", motion.max_gap, 1e-3, 10.0);
  yaml.number("play_length", motion.play_length, 0.0, 1.0);
  yaml.number("play_angle", motion.play_angle, 0.0, 3.0);
  if ((motion.play_length > 0.0) != (motion.play_angle > 0.0))
    yaml.problem("play_angle", "play_length and play_angle must be both zero or both above");
  yaml.number("joint_play_length", motion.joint_play_length, 1e-6, 1.0);
  yaml.number("joint_play_angle", motion.joint_play_angle, 1e-6, 3.0);
  yaml.number("joint_play_wrist", motion.joint_play_wrist, 1e-6, 3.0);
  std::string robot;
  yaml.text("robot", robot);
  try {
    if (!robot.empty()) knowRobot(besideConfiguration(file, robot), motion);
  } catch (const InvalidInput& error) {
    yaml.problem("robot", error.what());
  }
  yaml.refuseUnknownKeys();
}

void readCleaning(YamlReader yaml, TrainingConfig& config) {
  yaml.flag("enabled", config.cleaning_enabled);
  yaml.number("rotation_window", config.cleaning.limits.rotation_window, 0.0, 3.1416);
  yaml.number("workspace_margin", config.cleaning.limits.workspace_margin, 0.0, 10.0);
  yaml.number("speed", config.cleaning.limits.speed, 0.0, 100.0);
  yaml.number("angular_speed", config.cleaning.limits.angular_speed, 0.0, 1000.0);
  yaml.number("step", config.cleaning.limits.step, 0.0, 10.0);
  yaml.number("least_median_threshold", config.cleaning.least_median_threshold, 0.0, 1000.0);
  yaml.number("rotation_length", config.cleaning.rotation_length, 1e-4, 10.0);
  yaml.number("trajectory_share", config.cleaning.trajectory_share, 1e-3, 1.0);
  yaml.refuseUnknownKeys();
}

void readProcess(YamlReader yaml, TrainingConfig& config) {
  GpConfig& process = config.process;
  yaml.flag("enabled", config.process_enabled);
  choose(yaml, "kernel", process.kernel, kKernels);
  int lengths = 2;
  yaml.choice("length_scales", lengths, {"common", "per_vector", "per_feature"});
  process.ard = lengths > 0;
  config.tie_vectors = lengths == 1;
  choose(yaml, "criterion", process.criterion, {"likelihood", "validation"});
  choose(yaml, "mean", process.mean, kMeans);
  choose(yaml, "backend", process.backend, kBackends);
  int grouping = 2;
  yaml.choice("grouping", grouping, kGroupings);
  process.groups = groupsOf(grouping);
  count(yaml, "max_hyper_points", process.max_hyper_points, 10, 100000);
  count(yaml, "max_exact_points", process.max_exact_points, 10, 100000);
  count(yaml, "variance_points", process.variance_points, 0, 100000);
  process.exact_variance_points = process.variance_points;
  count(yaml, "inducing_points", process.inducing_points, 1, 10000);
  count(yaml, "restarts", process.restarts, 1, 100);
  yaml.number("log_length_prior", process.log_length_prior, 0.0, 100.0);
  double seed = static_cast<double>(process.seed);
  yaml.number("seed", seed, 0.0, 9e15);
  process.seed = static_cast<std::uint64_t>(seed);
  config.cleaning.seed = process.seed;
  yaml.refuseUnknownKeys();
}

void readPhysics(YamlReader yaml, const std::string& file, TrainingConfig& config) {
  std::string simulation;
  yaml.text("simulation", simulation);
  yaml.refuseUnknownKeys();
  if (simulation.empty()) return;
  try {
    config.simulation = std::make_shared<const SimulationConfig>(
        loadSimulationConfig(besideConfiguration(file, simulation)));
  } catch (const InvalidInput& error) {
    yaml.problem("simulation", error.what());
  }
}

}  // namespace

TrainingConfig loadTrainingConfig(const std::string& file) {
  YamlReader yaml = YamlReader::fromFile(file);
  TrainingConfig config;
  yaml.text("name", config.name);
  if (yaml.has("delay")) {
    YamlReader delay = yaml.section("delay");
    delay.flag("estimate", config.estimate_delay);
    delay.number("fixed", config.fixed_delay, -10.0, 10.0);
    delay.number("max", config.delay_max, 0.02, 10.0);
    delay.refuseUnknownKeys();
  }
  if (yaml.has("synchronisation")) {
    YamlReader synchronisation = yaml.section("synchronisation");
    synchronisation.number("max_gap", config.max_gap, 0.0, 100.0);
    synchronisation.number("max_gap_periods", config.max_gap_periods, 1.0, 1000.0);
    synchronisation.refuseUnknownKeys();
  }
  if (yaml.has("motion")) readMotion(yaml.section("motion"), file, config.motion);
  if (yaml.has("cleaning")) readCleaning(yaml.section("cleaning"), config);
  if (yaml.has("rigid")) {
    YamlReader rigid = yaml.section("rigid");
    rigid.number("rotation_length", config.rotation_length, 0.0, 10.0);
    rigid.refuseUnknownKeys();
  }
  if (yaml.has("process")) readProcess(yaml.section("process"), config);
  if (yaml.has("trust")) {
    YamlReader trust = yaml.section("trust");
    trust.number("workspace_margin", config.workspace_margin, 1e-4, 10.0);
    trust.number("fade_start", config.fade_start, 1e-3, 0.999);
    trust.number("fade_end", config.fade_end, 1e-3, 1.0);
    if (!(config.fade_start < config.fade_end))
      trust.problem("fade_end", "must be above fade_start");
    trust.refuseUnknownKeys();
  }
  if (yaml.has("physics")) readPhysics(yaml.section("physics"), file, config);
  yaml.refuseUnknownKeys();
  yaml.throwIfAnyProblem();
  config.text = textOf(file);
  return config;
}

void knowRobot(const std::string& file, MotionOptions& motion) {
  loadKinematicChain(file);  // says what is wrong with it
  motion.robot = textOf(file);
  checkMotionOptions(motion);
}

}  // namespace raven_correction
