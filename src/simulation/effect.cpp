// SPDX-License-Identifier: BSD-3-Clause
#include "raven_correction/simulation/effect.h"

#include <Eigen/LU>
#include <cmath>

#include "raven_correction/error.h"

namespace raven_correction {
namespace {

constexpr int kNewtonSteps = 8;       // a linear effect needs one
constexpr double kSolved = 1e-10;     // [rad or m]
constexpr double kDifference = 1e-6;  // of the numerical derivative [rad or m]

}  // namespace

const char* toString(EffectStage stage) noexcept {
  switch (stage) {
    case EffectStage::kCommand:
      return "command";
    case EffectStage::kDrive:
      return "drive";
    case EffectStage::kCable:
      return "cable";
    case EffectStage::kKinematics:
      return "kinematics";
    case EffectStage::kObservation:
      break;
  }
  return "observation";
}

std::string parameterLabel(const EffectParameter& parameter, const KinematicChain& robot) {
  if (parameter.joint < 0) return parameter.symbol;
  const std::string& joint = robot.joints()[static_cast<std::size_t>(parameter.joint)].name;
  if (parameter.source < 0) return parameter.symbol + "[" + joint + "]";
  const std::string& source = robot.joints()[static_cast<std::size_t>(parameter.source)].name;
  return parameter.symbol + "[" + joint + "<-" + source + "]";
}

void Effect::undo(const StepContext& context, JointVector& /*memory*/, JointVector& speed,
                  JointVector& q) const noexcept {
  const auto outOf = [&](const JointVector& in) {
    JointVector memory = in, out = in;
    apply(context, memory, out);
    return out;
  };
  JointVector in = q;
  JointVector missing = q - outOf(in);
  if (missing.isZero(0.0)) return;
  JointMatrix slope(q.size(), q.size());
  const auto differentiate = [&] {
    for (Eigen::Index j = 0; j < q.size(); ++j) {
      JointVector above = in, below = in;
      above(j) += kDifference;
      below(j) -= kDifference;
      slope.col(j) = (outOf(above) - outOf(below)) / (2.0 * kDifference);
    }
  };
  for (int k = 0; k < kNewtonSteps && missing.cwiseAbs().maxCoeff() > kSolved; ++k) {
    differentiate();
    in += slope.partialPivLu().solve(missing);
    if (!in.allFinite()) return;
    missing = q - outOf(in);
  }
  if (!(missing.cwiseAbs().maxCoeff() <= kSolved)) return;
  differentiate();
  const JointVector slower = slope.partialPivLu().solve(speed);
  if (!slower.allFinite()) return;
  q = in;
  speed = slower;
}

void Effect::setValue(int index, double value) {
  if (index < 0 || index >= static_cast<int>(parameters_.size()))
    throw InvalidInput(format("%s has %d parameters, there is no number %d", name(),
                              static_cast<int>(parameters_.size()), index));
  EffectParameter& parameter = parameters_[static_cast<std::size_t>(index)];
  if (!(value >= parameter.lower && value <= parameter.upper))
    throw InvalidInput(format("%s: %s = %g %s is outside [%g, %g]", name(),
                              parameter.symbol.c_str(), value, parameter.unit.c_str(),
                              parameter.lower, parameter.upper));
  parameter.value = value;
  values_[static_cast<std::size_t>(index)] = value;
}

void Effect::setDeviation(int index, double deviation) {
  if (index < 0 || index >= static_cast<int>(parameters_.size()))
    throw InvalidInput(format("%s has no parameter number %d", name(), index));
  if (!(deviation >= 0.0))
    throw InvalidInput(format("%s: a standard deviation of %g, must be >= 0", name(), deviation));
  parameters_[static_cast<std::size_t>(index)].deviation = deviation;
}

void Effect::addParameter(EffectParameter parameter) {
  parameters_.push_back(std::move(parameter));
  values_.push_back(parameters_.back().value);
}

void Effect::addParameter(const char* symbol, const char* unit, double lower, double upper) {
  EffectParameter parameter;
  parameter.symbol = symbol;
  parameter.unit = unit;
  parameter.lower = lower;
  parameter.upper = upper;
  addParameter(parameter);
}

void Effect::addJointParameters(const char* symbol, const KinematicChain& robot,
                                const JointRange& range, Sign sign) {
  for (int j = 0; j < robot.size(); ++j) {
    const bool revolute = robot.joints()[static_cast<std::size_t>(j)].type == JointType::kRevolute;
    EffectParameter parameter;
    parameter.symbol = symbol;
    parameter.joint = j;
    parameter.unit = revolute ? range.revolute_unit : range.prismatic_unit;
    parameter.upper = revolute ? range.revolute_limit : range.prismatic_limit;
    parameter.lower = sign == Sign::kBoth ? -parameter.upper : 0.0;
    addParameter(parameter);
  }
}

void Effect::addPoseParameters(double translation_limit, double rotation_limit) {
  for (const char* symbol : {"x", "y", "z"})
    addParameter(symbol, "m", -translation_limit, translation_limit);
  for (const char* symbol : {"rx", "ry", "rz"})
    addParameter(symbol, "rad", -rotation_limit, rotation_limit);
}

Pose Effect::poseValue(int first) const noexcept {
  return {{value(first), value(first + 1), value(first + 2)},
          expRotation({value(first + 3), value(first + 4), value(first + 5)})};
}

}  // namespace raven_correction
