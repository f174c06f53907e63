// SPDX-License-Identifier: BSD-3-Clause
// Which models may correct: those that have passed a pre-flight, or were let through without one,
// since this node started and the robot was homed last. How a model is judged is
// evaluation/preflight.h, what the corrector does about it corrected_arm.h.
#pragma once

#include <atomic>
#include <cstdint>
#include <map>
#include <mutex>
#include <string>

namespace raven_correction {

/// Numbers as in CorrectionStatus.msg.
enum class PreflightState : std::uint8_t {
  kNotRequired = 0,
  kNeeded = 1,
  kPassed = 2,
  kOverridden = 3,
};
/// "not required", "needed", "passed", "overridden".
const char* preflightStateName(PreflightState state) noexcept;
/// A model in this state may correct.
constexpr bool isCleared(PreflightState state) noexcept { return state != PreflightState::kNeeded; }

/// Thread-safe.
class PreflightGate {
 public:
  explicit PreflightGate(bool required) : required_(required) {}

  bool required() const noexcept { return required_; }
  /// Homings since the start.
  std::uint32_t homings() const noexcept { return homings_.load(); }
  /// The robot was homed: what was known of every model is void. Without lock.
  void noteHoming() noexcept { ++homings_; }
  /// @param how      kPassed or kOverridden
  /// @param homings  homings() when what this is based on began: one that came in between voids it
  void clear(const std::string& model, PreflightState how, std::uint32_t homings);
  /// The model has failed.
  void revoke(const std::string& model);
  PreflightState of(const std::string& model) const;

 private:
  struct Clearance {
    PreflightState how;
    std::uint32_t homings;
  };
  const bool required_;
  std::atomic<std::uint32_t> homings_{0};
  mutable std::mutex mutex_;  // of what follows
  std::map<std::string, Clearance> cleared_;
};

}  // namespace raven_correction
