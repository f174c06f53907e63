// SPDX-License-Identifier: BSD-3-Clause
#include "raven_correction/diagnosis/hypothesis.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <map>
#include <utility>

#include "raven_correction/error.h"
#include "raven_correction/geometry/statistics.h"
#include "raven_correction/simulation/effect_registry.h"

namespace raven_correction {
namespace {

/// Parameters that do nothing while the amplitude of their effect is 0.
struct Shape {
  const char* effect;
  const char* symbol;
  bool fixed;     // see Hypothesis::fixed_shapes
  bool periodic;  // a wave number: at least one wave over the range of the joint
};
constexpr Shape kShapes[] = {{"creep", "T", false, false},
                             {"pulley_eccentricity", "N", false, true},
                             {"pulley_eccentricity", "phi", false, false},
                             {"registration_shift", "t0", true, false}};

constexpr char kMotorSaturation[] = "motor_saturation";

/// Effects whose joints may each err by too little to tell: see togetherHypotheses().
constexpr const char* kOfEveryJoint[] = {"backlash",       "cable_stretch", "drive_friction",
                                         "joint_coupling", "joint_gain",    "joint_offset",
                                         "link_geometry"};

/// Parameters that are no hypothesis of their own, see allHypotheses().
bool isLeftOut(const std::string& effect, const std::string& symbol) {
  return effect == kMotorSaturation && symbol != "T" && symbol != "v";
}

const Shape* shapeOf(const std::string& effect, const std::string& symbol) {
  for (const Shape& shape : kShapes)
    if (effect == shape.effect && symbol == shape.symbol) return &shape;
  return nullptr;
}

constexpr double kLeastPhase = 6.28318530717958648;  // less is an offset, or a wrong ratio [rad]
constexpr double kAmplitudeShare = 4e-3;  // of a parameter's range: a size that shows [-]

bool possible(const Effect& effect, const Recording& recording) {
  const EffectStage stage = effect.stage();
  const bool geometric = stage == EffectStage::kKinematics || stage == EffectStage::kObservation;
  const bool before_motors = stage == EffectStage::kCommand || stage == EffectStage::kDrive;
  if (geometric && !recording.has_kinematics) return false;
  if (before_motors && recording.source == DriveSource::kEncoders) return false;
  if (!effect.needsLoad()) return true;
  double mass = 0.0;
  for (const Joint& joint : recording.robot.joints()) mass += joint.mass;
  return recording.has_kinematics && mass > 0.0 && recording.robot.gravity().norm() > 0.0;
}

/// The hypotheses of one effect: amplitudes that belong together, and the shapes of their joint.
void addHypothesesOf(const Effect& effect, const RecordingSummary& summary,
                     std::vector<Hypothesis>& all) {
  const std::vector<EffectParameter>& parameters = effect.parameters();
  Hypothesis whole;
  whole.effect = effect.name();
  const auto addShapes = [&](int joint, Hypothesis& hypothesis) {
    for (std::size_t i = 0; i < parameters.size(); ++i) {
      const Shape* const shape = shapeOf(effect.name(), parameters[i].symbol);
      if (!shape || parameters[i].joint != joint) continue;
      ParameterHandle handle{effect.name(), static_cast<int>(i)};
      if (shape->periodic) handle.lower = kLeastPhase / std::max(1e-9, summary.range(joint));
      hypothesis.parameters.push_back(handle);
      ++hypothesis.shapes;
      hypothesis.fixed_shapes += shape->fixed;
    }
  };
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    const EffectParameter& parameter = parameters[i];
    if (shapeOf(effect.name(), parameter.symbol)) continue;
    if (isLeftOut(effect.name(), parameter.symbol)) continue;
    if (parameter.joint < 0) {
      whole.parameters.push_back({effect.name(), static_cast<int>(i)});
      continue;
    }
    Hypothesis one;
    one.effect = effect.name();
    one.joints = {parameter.joint};
    if (parameter.source >= 0) one.joints.push_back(parameter.source);
    one.parameters.push_back({effect.name(), static_cast<int>(i)});
    addShapes(parameter.joint, one);
    all.push_back(one);
  }
  if (whole.parameters.empty()) return;
  addShapes(-1, whole);
  all.push_back(whole);
}

const EffectParameter& parameterIn(const Effect& effect, const ParameterHandle& handle) {
  return effect.parameters()[static_cast<std::size_t>(handle.index)];
}

/// How many symbols an effect has for one joint, without shapes.
bool hasSeveralSymbols(const Hypothesis& hypothesis, const Effect& effect) {
  const EffectParameter& mine = parameterIn(effect, hypothesis.parameters.front());
  for (const EffectParameter& other : effect.parameters())
    if (other.joint == mine.joint && other.symbol != mine.symbol &&
        !shapeOf(effect.name(), other.symbol))
      return true;
  return false;
}

/// Whether its parameters say how one joint is moved by others.
bool isMoved(const Hypothesis& hypothesis, const Effect& effect) {
  return parameterIn(effect, hypothesis.parameters.front()).source >= 0;
}

}  // namespace

bool isLimit(const std::string& effect, const std::string& symbol) noexcept {
  return symbol == "v" && (effect == kMotorSaturation || effect == "speed_limit");
}

std::string hypothesisLabel(const Hypothesis& hypothesis, const KinematicChain& robot) {
  std::string label = hypothesis.effect;
  if (hypothesis.joints.empty()) return label;
  const std::unique_ptr<Effect> effect = makeEffect(hypothesis.effect, robot);
  if (hasSeveralSymbols(hypothesis, *effect))
    label += " " + parameterIn(*effect, hypothesis.parameters.front()).symbol;
  const std::vector<std::string> names = robot.jointNames();
  const bool moved = isMoved(hypothesis, *effect);
  for (std::size_t i = 0; i < hypothesis.joints.size(); ++i) {
    const char* const before = i == 0 ? " of " : moved && i == 1 ? " by " : ", ";
    label += before + names[static_cast<std::size_t>(hypothesis.joints[i])];
  }
  return label;
}

std::vector<Hypothesis> togetherHypotheses(const std::vector<Hypothesis>& single,
                                           const KinematicChain& robot) {
  std::map<std::string, std::vector<ParameterHandle>> groups;
  for (const Hypothesis& one : single) {
    const auto is_of_every_joint = [&](const char* effect) { return one.effect == effect; };
    if (one.shapes > 0 || one.joints.empty() ||
        std::none_of(std::begin(kOfEveryJoint), std::end(kOfEveryJoint), is_of_every_joint))
      continue;
    const std::unique_ptr<Effect> effect = makeEffect(one.effect, robot);
    std::string key = one.effect;
    key += " " + parameterIn(*effect, one.parameters.front()).symbol;
    std::vector<std::string> keys{key};
    if (isMoved(one, *effect)) keys.push_back(key + " " + std::to_string(one.joints.front()));
    for (const std::string& of : keys)
      groups[of].insert(groups[of].end(), one.parameters.begin(), one.parameters.end());
  }
  std::vector<Hypothesis> together;
  for (auto& [key, parameters] : groups)
    if (parameters.size() > 1) together.push_back(hypothesisOf(std::move(parameters), robot));
  return together;
}

Hypothesis hypothesisOf(std::vector<ParameterHandle> parameters, const KinematicChain& robot) {
  Hypothesis hypothesis;
  hypothesis.effect = parameters.front().effect;
  hypothesis.parameters = std::move(parameters);
  const std::unique_ptr<Effect> effect = makeEffect(hypothesis.effect, robot);
  const bool moved = isMoved(hypothesis, *effect);
  if (moved && partsOf(hypothesis, robot).size() > 1) return hypothesis;
  for (const ParameterHandle& handle : hypothesis.parameters) {
    const EffectParameter& parameter = parameterIn(*effect, handle);
    if (moved && hypothesis.joints.empty()) hypothesis.joints.push_back(parameter.joint);
    hypothesis.joints.push_back(moved ? parameter.source : parameter.joint);
  }
  return hypothesis;
}

std::vector<std::vector<ParameterHandle>> partsOf(const Hypothesis& hypothesis,
                                                  const KinematicChain& robot) {
  const std::unique_ptr<Effect> effect = makeEffect(hypothesis.effect, robot);
  if (!isMoved(hypothesis, *effect)) return {hypothesis.parameters};
  std::vector<std::vector<ParameterHandle>> parts;
  int joint = -1;
  for (const ParameterHandle& handle : hypothesis.parameters) {
    const EffectParameter& parameter = parameterIn(*effect, handle);
    if (parts.empty() || parameter.joint != joint) parts.emplace_back();
    joint = parameter.joint;
    parts.back().push_back(handle);
  }
  return parts;
}

std::vector<std::string> parameterNames(const Hypothesis& hypothesis, const KinematicChain& robot) {
  const std::unique_ptr<Effect> effect = makeEffect(hypothesis.effect, robot);
  std::map<std::string, int> count;
  for (const ParameterHandle& handle : hypothesis.parameters)
    ++count[parameterIn(*effect, handle).symbol];
  std::vector<std::string> names;
  for (const ParameterHandle& handle : hypothesis.parameters) {
    const EffectParameter& parameter = parameterIn(*effect, handle);
    names.push_back(count[parameter.symbol] == 1 ? parameter.symbol
                                                 : parameterLabel(parameter, robot));
  }
  return names;
}

std::vector<Hypothesis> allHypotheses(const Recording& recording,
                                      const SimulationConfig& simulation) {
  const RecordingSummary summary = summarise(recording);
  std::vector<Hypothesis> all;
  for (const std::string& name : effectNames()) {
    const std::unique_ptr<Effect> effect = makeEffect(name, recording.robot);
    if (possible(*effect, recording)) addHypothesesOf(*effect, summary, all);
  }
  const bool coupled = recording.has_kinematics && !simulation.coupling.empty();
  const JointMatrix travel =
      coupled ? simulation.coupling.motorTravel(recording.robot)
              : JointMatrix(JointMatrix::Zero(recording.robot.size(), recording.robot.size()));
  const auto is_tracking_lag = [&](const Hypothesis& hypothesis) {
    return hypothesis.effect == kMotorSaturation && travel.row(hypothesis.joints.front()).isZero();
  };
  all.erase(std::remove_if(all.begin(), all.end(), is_tracking_lag), all.end());
  return all;
}

RecordingSummary summarise(const Recording& recording) {
  const int n = recording.robot.size();
  RecordingSummary summary;
  summary.start = std::min(recording.motions.front().setpoints.front().stamp,
                           recording.motions.front().observations.front().stamp);
  std::vector<std::vector<double>> speeds(static_cast<std::size_t>(n));
  JointVector lowest = JointVector::Constant(n, std::numeric_limits<double>::max());
  JointVector highest = -lowest;
  for (const Recording::Motion& motion : recording.motions) {
    summary.duration = std::max(summary.duration, motion.observations.back().stamp - summary.start);
    for (std::size_t i = 0; i < motion.setpoints.size(); ++i) {
      lowest = lowest.cwiseMin(motion.setpoints[i].joints);
      highest = highest.cwiseMax(motion.setpoints[i].joints);
      if (i < 2) continue;
      const double step = motion.setpoints[i].stamp - motion.setpoints[i - 2].stamp;
      if (!(step > 1e-3)) continue;
      for (int j = 0; j < n; ++j)
        speeds[static_cast<std::size_t>(j)].push_back(
            std::abs(motion.setpoints[i].joints(j) - motion.setpoints[i - 2].joints(j)) / step);
    }
  }
  summary.range = highest - lowest;
  summary.peak_speed = JointVector::Zero(n);
  for (int j = 0; j < n; ++j) {
    auto& values = speeds[static_cast<std::size_t>(j)];
    if (!values.empty()) summary.peak_speed(j) = quantile(std::move(values), 0.99);
  }
  return summary;
}

std::vector<Eigen::VectorXd> startingPoints(const Hypothesis& hypothesis,
                                            const RecordingSummary& recording,
                                            const SimulationConfig& simulation) {
  const auto k = static_cast<Eigen::Index>(hypothesis.parameters.size());
  Eigen::VectorXd base(k);
  for (Eigen::Index i = 0; i < k; ++i) {
    const EffectParameter parameter =
        parameterOf(simulation, hypothesis.parameters[static_cast<std::size_t>(i)]);
    base(i) = kAmplitudeShare * (parameter.upper - std::max(0.0, parameter.lower));
  }
  const auto with = [&](Eigen::Index index, const std::vector<double>& values) {
    std::vector<Eigen::VectorXd> starts;
    for (const double value : values) {
      const EffectParameter parameter =
          parameterOf(simulation, hypothesis.parameters[static_cast<std::size_t>(index)]);
      if (!(value > parameter.lower && value < parameter.upper)) continue;
      starts.push_back(base);
      starts.back()(index) = value;
    }
    return starts;
  };
  const std::string& effect = hypothesis.effect;
  if (effect == "pulley_eccentricity" || effect == "registration_shift") return {};
  if (effect == "command_delay") return with(0, {0.02, 0.1, 0.2});
  if (effect == "tracking_lag") return with(0, {0.02, 0.1});
  const std::string symbol = parameterOf(simulation, hypothesis.parameters.front()).symbol;
  if (effect == kMotorSaturation)
    return with(0,
                symbol == "T" ? std::vector<double>{0.02, 0.06} : std::vector<double>{20, 10, 5});
  if (effect == "speed_limit") {
    const double peak = recording.peak_speed(hypothesis.joints.front());
    return with(0, {0.95 * peak, 0.8 * peak, 0.6 * peak, 0.4 * peak, 0.2 * peak});
  }
  if (effect == "creep")
    return with(1, {0.05 * recording.duration, 0.2 * recording.duration, 0.7 * recording.duration});
  return {base};
}

}  // namespace raven_correction
