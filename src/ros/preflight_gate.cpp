// SPDX-License-Identifier: BSD-3-Clause
#include "raven_correction/ros/preflight_gate.h"

namespace raven_correction {

const char* preflightStateName(PreflightState state) noexcept {
  switch (state) {
    case PreflightState::kNotRequired:
      return "not required";
    case PreflightState::kNeeded:
      return "needed";
    case PreflightState::kPassed:
      return "passed";
    case PreflightState::kOverridden:
      return "overridden";
  }
  return "unknown";
}

void PreflightGate::clear(const std::string& model, PreflightState how, std::uint32_t homings) {
  const std::lock_guard<std::mutex> lock(mutex_);
  cleared_[model] = {how, homings};
}

void PreflightGate::revoke(const std::string& model) {
  const std::lock_guard<std::mutex> lock(mutex_);
  cleared_.erase(model);
}

PreflightState PreflightGate::of(const std::string& model) const {
  if (!required_) return PreflightState::kNotRequired;
  const std::lock_guard<std::mutex> lock(mutex_);
  const auto found = cleared_.find(model);
  return found != cleared_.end() && found->second.homings == homings_.load()
             ? found->second.how
             : PreflightState::kNeeded;
}

}  // namespace raven_correction
