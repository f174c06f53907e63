// SPDX-License-Identifier: BSD-3-Clause
#include "raven_correction/simulation/inverse_arm.h"

#include <algorithm>
#include <cmath>

#include "raven_correction/error.h"
#include "raven_correction/robot/gravity_load.h"

namespace raven_correction {
namespace {

constexpr double kSpeedTime = 0.1;                    // [s]
constexpr double kLeastTime = 0.03;                   // of a path to take a speed from [s]
constexpr double kMostAhead = 0.2;                    // [s]
constexpr double kMostTurn = 3.14159265358979323846;  // between two corners: another turn [rad]

bool differs(const KinematicChain& a, const KinematicChain& b) {
  for (int j = 0; j < a.size(); ++j) {
    const Joint &x = a.joints()[static_cast<std::size_t>(j)],
                &y = b.joints()[static_cast<std::size_t>(j)];
    if (x.alpha != y.alpha || x.a != y.a || x.d_offset != y.d_offset) return true;
  }
  return false;
}

IkOptions fromTheSeedOnly() {
  IkOptions options;
  options.search_elsewhere = false;  // bounds the time
  return options;
}

}  // namespace

InverseArm::InverseArm(const SimulationConfig& config, const InverseTiming& timing)
    : config_(config),
      real_chain_(config.robot),
      nominal_ik_(config.robot, fromTheSeedOnly()),
      real_ik_(config.robot, fromTheSeedOnly()),
      age_(timing.age) {
  if (config_.robot.size() == 0) throw InvalidInput("simulation " + config_.name + " has no robot");
  if (!std::isfinite(timing.delay) || !(timing.hold >= 0.0) || !std::isfinite(timing.hold) ||
      !(timing.age >= 0.0) || !std::isfinite(timing.age))
    throw InvalidInput(format(
        "inverse simulation: delay = %g s must be finite, hold = %g s and age = %g s also >= 0",
        timing.delay, timing.hold, timing.age));
  if (config_.effects.size() > kMostEffects)
    throw InvalidInput(format("simulation %s has %zu effects, more than there are kinds",
                              config_.name.c_str(), config_.effects.size()));
  Pose X_base_robot, X_tool_observed;
  lead_ = timing.delay - (config_.setpoints == SetpointMode::kHold ? timing.hold : 0.0);
  for (const auto& effect : config_.effects) {
    lead_ -= effect->delay();
    real_chain_ = effect->links(real_chain_);
    X_base_robot = X_base_robot * effect->base();
    X_tool_observed = X_tool_observed * effect->tool();
    needs_load_ = needs_load_ || effect->needsLoad();
  }
  lead_ = std::max(lead_, -kMostAhead);
  X_robot_base_ = X_base_robot.inverse();
  X_observed_tool_ = X_tool_observed.inverse();
  links_differ_ = differs(config_.robot, real_chain_);
  if (links_differ_) real_ik_ = InverseKinematics(real_chain_, fromTheSeedOnly());
  if (!config_.coupling.empty()) motor_travel_ = config_.coupling.motorTravel(config_.robot);
}

bool InverseArm::jointsOf(const Pose& X_base_tool, const JointVector& seed, bool from_home,
                          JointVector& joints) const noexcept {
  Pose X = X_base_tool;
  for (auto effect = config_.effects.rbegin(); effect != config_.effects.rend(); ++effect)
    if ((*effect)->stage() == EffectStage::kObservation) X = (*effect)->undoObserve(age_, X);
  X = X_robot_base_ * X * X_observed_tool_;
  X.q.normalize();
  IkResult result;
  if (!links_differ_ || from_home) {
    result = nominal_ik_.solve(X, seed);
    if (!reproducesPose(result.status)) return false;
  }
  if (links_differ_) {
    result = real_ik_.solve(X, from_home ? result.joints : seed);
    if (!reproducesPose(result.status)) return false;
  }
  joints = result.joints;
  return joints.allFinite();
}

JointVector InverseArm::jointsAt(const ToolPath& path, const Joints& joints,
                                 double ago) const noexcept {
  if (path.count == 1 || ago >= path.corners[path.count - 1].ago) return joints[path.count - 1];
  std::size_t older = 1;  // ahead of now: straight on
  while (path.corners[older].ago < ago) ++older;
  const double from = path.corners[older - 1].ago, to = path.corners[older].ago;
  return joints[older - 1] + (ago - from) / (to - from) * (joints[older] - joints[older - 1]);
}

void InverseArm::undoStages(bool first, Memory& memory, JointVector& speed,
                            JointVector& q) const noexcept {
  const JointVector load = needs_load_ ? gravityLoad(real_chain_, q, 0.0)
                                       : JointVector(JointVector::Zero(config_.robot.size()));
  const StepContext context{age_, config_.step, config_.robot.home(), load,
                            motor_travel_.size() > 0 ? &motor_travel_ : nullptr};
  for (std::size_t i = config_.effects.size(); i-- > 0;) {
    const Effect& effect = *config_.effects[i];
    if (effect.stage() != EffectStage::kDrive && effect.stage() != EffectStage::kCable) continue;
    if (first) memory[i] = q;
    effect.undo(context, memory[i], speed, q);
  }
}

InverseArm::Answer InverseArm::solve(const ToolPath& path) const noexcept {
  Answer answer;
  if (path.count == 0 || path.count > ToolPath::kMost) return answer;
  Joints joints;
  for (std::size_t c = 0; c < path.count; ++c) {
    const JointVector& seed = c == 0 ? config_.robot.home() : joints[c - 1];
    if (!jointsOf(path.corners[c].pose, seed, c == 0, joints[c])) return answer;
    if (c > 0 && (joints[c] - joints[c - 1]).cwiseAbs().maxCoeff() > kMostTurn) return answer;
  }
  const JointVector q_there = jointsAt(path, joints, lead_);
  const double longest = path.corners[path.count - 1].ago;
  JointVector speed = JointVector::Zero(config_.robot.size());
  if (longest > 0.0) {
    // From t_e on where there is enough of the path, else over its newest part.
    const double end = std::max(0.0, lead_ - kSpeedTime);
    const double begin = std::max(lead_, end + kLeastTime);
    speed = (jointsAt(path, joints, end) - jointsAt(path, joints, begin)) / (begin - end);
  }
  Memory memory;
  bool first = true;
  for (std::size_t c = path.count; c-- > 0 && path.corners[c].ago > lead_; first = false) {
    JointVector q = joints[c], ignored = speed;
    undoStages(first, memory, ignored, q);
  }
  JointVector q = q_there;
  undoStages(first, memory, speed, q);
  if (!q.allFinite()) return answer;
  answer.setpoint = q;
  answer.command = config_.robot.forward(q);
  answer.reached = true;
  return answer;
}

}  // namespace raven_correction
