// SPDX-License-Identifier: BSD-3-Clause
#include "raven_correction/ros/command_gate.h"

#include <cmath>

#include "raven_correction/error.h"
#include "raven_correction/ros/names.h"

namespace raven_correction {
const char* toString(CommandVerdict verdict) noexcept {
  switch (verdict) {
    case CommandVerdict::kTaken:
      return "taken";
    case CommandVerdict::kClipped:
      return "clipped";
    case CommandVerdict::kFirstDiscarded:
      return "first discarded";
    case CommandVerdict::kLatched:
      return "latched";
    case CommandVerdict::kWrongFrame:
      return "wrong frame";
    case CommandVerdict::kNotFinite:
      return "not finite";
    case CommandVerdict::kNotUnit:
      return "quaternion not unit";
    case CommandVerdict::kTooFar:
      return "too far";
    case CommandVerdict::kNoIk:
      break;
  }
  return "out of reach";
}

bool isTaken(CommandVerdict verdict) noexcept {
  return verdict == CommandVerdict::kTaken || verdict == CommandVerdict::kClipped;
}

CommandGate::CommandGate(const CommandGateConfig& config)
    : config_(config), arrival_(config.stamp_tolerance) {
  config_.base_frame = withoutSlash(config_.base_frame);
  if (config_.base_frame.empty()) throw InvalidInput("the base frame of commands has no name");
  const struct {
    const char* name;
    double value;
  } lengths[] = {{"max_step", config.max_step}, {"reject_step", config.reject_step}};
  for (const auto& length : lengths)
    if (!(length.value >= 0.0 && std::isfinite(length.value)))
      throw InvalidInput(format("%s = %g, must be >= 0", length.name, length.value));
}

void CommandGate::reset() noexcept {
  heard_ = false;
  arrival_.reset();
}

CommandVerdict CommandGate::judge(double now, const Eigen::Vector3d& measured,
                                  ArrivedCommand& command) {
  if (command.replay) return CommandVerdict::kLatched;
  if (withoutSlash(command.frame) != config_.base_frame) return CommandVerdict::kWrongFrame;
  Pose& pose = command.pose.pose;
  if (!isFinite(pose)) return CommandVerdict::kNotFinite;
  if (!hasUnitQuaternion(pose)) return CommandVerdict::kNotUnit;
  if (config_.discard_first && !heard_) {
    heard_ = true;
    return CommandVerdict::kFirstDiscarded;
  }

  const Eigen::Vector3d step = pose.p - measured;
  const double length = step.norm();
  if (config_.reject_step > 0.0 && length > config_.reject_step) return CommandVerdict::kTooFar;
  const bool clipped = config_.max_step > 0.0 && length > config_.max_step;
  if (clipped) pose.p = measured + step * (config_.max_step / length);
  command.pose.stamp = arrival_.actingTime(now, command.pose.stamp);
  return clipped ? CommandVerdict::kClipped : CommandVerdict::kTaken;
}

}  // namespace raven_correction
