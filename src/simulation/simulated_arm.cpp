// SPDX-License-Identifier: BSD-3-Clause
#include "raven_correction/simulation/simulated_arm.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "raven_correction/error.h"
#include "raven_correction/robot/gravity_load.h"

namespace raven_correction {
namespace {

constexpr std::size_t kMaxPending = 100000;  // commands that wait: more means a stamp in the future

}  // namespace

SimulatedArm::SimulatedArm(const SimulationConfig& config, double start)
    : config_(config), ik_(config.robot), real_chain_(config.robot) {
  if (config_.robot.size() == 0) throw InvalidInput("simulation " + config_.name + " has no robot");
  if (!(config_.step > 0.0))
    throw InvalidInput(format("simulation step = %g s, must be > 0", config_.step));
  checkGripper(config_.gripper);
  for (const auto& effect : config_.effects) {
    delay_ += effect->delay();
    real_chain_ = effect->links(real_chain_);
    X_base_robot_ = X_base_robot_ * effect->base();
    X_tool_observed_ = X_tool_observed_ * effect->tool();
    needs_load_ = needs_load_ || effect->needsLoad();
  }
  if (!config_.coupling.empty()) motor_travel_ = config_.coupling.motorTravel(config_.robot);
  reset(start);
}

void SimulatedArm::reset(double start, const JointVector& joints) {
  if (joints.size() != config_.robot.size() || !joints.allFinite() || !std::isfinite(start))
    throw InvalidInput(
        format("an arm of %d joints cannot be reset to %d joints or to a value that "
               "is not finite",
               config_.robot.size(), static_cast<int>(joints.size())));
  state_ = ArmState();
  state_.start = start;
  state_.time = start;
  state_.setpoint = joints;
  state_.joint = joints;
  state_.active = {start, joints};
  state_.command_joints = joints;
  state_.last_stamp = -std::numeric_limits<double>::infinity();
  state_.last_jaw_stamp = state_.last_stamp;
  state_.memory.assign(config_.effects.size(), joints);
  // Whatever comes in is what an effect remembers: every play in its middle, every lag at rest.
  const JointVector at_rest = load();
  JointVector q = joints;
  runStages(contextOf(start, config_.step, at_rest), true, q);
}

IkStatus SimulatedArm::reset(double start, const Pose& X_base_tool) {
  const IkResult result = ik_.solve(X_base_tool, config_.robot.home());
  if (reproducesPose(result.status)) reset(start, config_.robot.clamp(result.joints));
  return result.status;
}

bool SimulatedArm::accepts(double stamp) const noexcept {
  return std::isfinite(stamp) && stamp >= state_.last_stamp && state_.pending.size() < kMaxPending;
}

void SimulatedArm::enqueue(double stamp, const JointVector& joints) noexcept {
  state_.command_joints = joints;
  state_.last_stamp = stamp;
  state_.pending.push_back({stamp, joints});
}

IkStatus SimulatedArm::command(const StampedPose& X_base_tool) noexcept {
  IkStatus status = IkStatus::kInvalidInput;
  if (accepts(X_base_tool.stamp)) {
    const IkResult result = ik_.solve(X_base_tool.pose, state_.command_joints);
    status = result.status;
    if (reproducesPose(status)) enqueue(X_base_tool.stamp, config_.robot.clamp(result.joints));
  }
  ++counts_[static_cast<std::size_t>(status)];
  return status;
}

bool SimulatedArm::command(double stamp, const JointVector& joints) noexcept {
  if (!accepts(stamp) || joints.size() != config_.robot.size() || !joints.allFinite()) return false;
  enqueue(stamp, joints);
  return true;
}

bool SimulatedArm::commandJaw(double stamp, double opening) noexcept {
  if (!std::isfinite(stamp) || !std::isfinite(opening) || stamp < state_.last_jaw_stamp ||
      state_.pending_jaw.size() >= kMaxPending)
    return false;
  state_.last_jaw_stamp = stamp;
  const GripperConfig& gripper = config_.gripper;
  state_.pending_jaw.push_back({stamp, std::clamp(opening, gripper.lower, gripper.upper)});
  return true;
}

/// Set-points and openings whose delay has passed become what the drives aim at.
void SimulatedArm::activateDue() noexcept {
  while (!state_.pending.empty() && state_.pending.front().stamp + delay_ <= state_.time) {
    state_.active = state_.pending.front();
    state_.pending.pop_front();
  }
  while (!state_.pending_jaw.empty() && state_.pending_jaw.front().stamp + delay_ <= state_.time) {
    state_.gripper.target = state_.pending_jaw.front().opening;
    state_.pending_jaw.erase(state_.pending_jaw.begin());
  }
}

void SimulatedArm::advanceTo(double time) noexcept {
  while (state_.time < time) {
    // A step ends where a set-point changes, so a held set-point is constant during every step.
    activateDue();
    double end = std::min(time, state_.time + config_.step);
    if (!state_.pending.empty()) end = std::min(end, state_.pending.front().stamp + delay_);
    if (!state_.pending_jaw.empty()) end = std::min(end, state_.pending_jaw.front().stamp + delay_);
    if (!(end > state_.time)) end = std::nextafter(state_.time, time);
    step(end);
  }
}

JointVector SimulatedArm::setpointAt(double time) const noexcept {
  if (config_.setpoints == SetpointMode::kHold || state_.pending.empty())
    return state_.active.joints;
  const ArmState::Setpoint& next = state_.pending.front();
  const double span = next.stamp - state_.active.stamp;
  if (!(span > 0.0)) return state_.active.joints;
  const double share = std::clamp((time - delay_ - state_.active.stamp) / span, 0.0, 1.0);
  return state_.active.joints + share * (next.joints - state_.active.joints);
}

JointVector SimulatedArm::load() const noexcept {
  if (!needs_load_) return JointVector::Zero(config_.robot.size());
  return gravityLoad(real_chain_, state_.joint, state_.gripper.payload);
}

void SimulatedArm::runStages(const StepContext& context, bool at_reset, JointVector& q) noexcept {
  bool past_drive = false;
  for (std::size_t i = 0; i < config_.effects.size(); ++i) {
    const Effect& effect = *config_.effects[i];
    const EffectStage stage = effect.stage();
    if (stage != EffectStage::kDrive && stage != EffectStage::kCable) continue;
    if (stage == EffectStage::kCable && !past_drive) {
      state_.motor = q;
      past_drive = true;
    }
    if (at_reset) state_.memory[i] = q;
    effect.apply(context, state_.memory[i], q);
  }
  if (!past_drive) state_.motor = q;
  state_.joint = q;
}

StepContext SimulatedArm::contextOf(double end, double step,
                                    const JointVector& load) const noexcept {
  return {std::max(0.0, end - state_.start), step, config_.robot.home(), load,
          motor_travel_.size() > 0 ? &motor_travel_ : nullptr};
}

void SimulatedArm::step(double end) noexcept {
  const JointVector now = load();
  const StepContext context = contextOf(end, end - state_.time, now);
  state_.time = end;
  state_.setpoint = setpointAt(end);
  JointVector q = state_.setpoint;
  runStages(context, false, q);
  advanceGripper(config_.gripper, context.step, state_.gripper);
}

JointVector SimulatedArm::encoderJoints() const noexcept {
  if (!config_.quantise_encoders || config_.coupling.empty()) return state_.motor;
  return config_.coupling.quantised(config_.robot, state_.motor, state_.gripper.opening);
}

Pose SimulatedArm::toolPoseAt(double since_start, const JointVector& joints) const noexcept {
  Pose X = X_base_robot_ * real_chain_.forward(joints) * X_tool_observed_;
  for (const auto& effect : config_.effects)
    if (effect->stage() == EffectStage::kObservation) X = effect->observe(since_start, X);
  return X;
}

}  // namespace raven_correction
