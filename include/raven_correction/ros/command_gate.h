// SPDX-License-Identifier: BSD-3-Clause
// Which poses the controller of a Raven takes and which it drops in silence: the rules of the
// Berkeley and UW software, so that what works in simulation is not surprised by the robot.
#pragma once

#include <array>
#include <cstdint>
#include <string>

#include "raven_correction/geometry/stream.h"
#include "raven_correction/ros/arrival.h"

namespace raven_correction {

struct CommandGateConfig {
  std::string base_frame = "0_link";  ///< the only frame that is taken; "/0_link" is the same
  bool discard_first = true;      ///< Berkeley: the first command ever heard only starts a timer
  double max_step = 0.0;          ///< longer steps from the measured position are clipped [m]
  double reject_step = 0.0;       ///< longer steps are dropped [m]; 0 switches either rule off
  double stamp_tolerance = 0.25;  ///< see Arrival [s]
};

enum class CommandVerdict {
  kTaken,
  kClipped,         ///< taken, but shortened to max_step
  kFirstDiscarded,  ///< the first command after the start of the controller
  kLatched,         ///< replay of a latched publisher: it may be old
  kWrongFrame,      ///< empty or other than the base frame
  kNotFinite,
  kNotUnit,  ///< quaternion not of unit length
  kTooFar,   ///< further from the measured position than reject_step
  kNoIk,     ///< no joints reach the pose
};
constexpr int kCommandVerdicts = 9;
/// "taken", "wrong frame", ...
const char* toString(CommandVerdict verdict) noexcept;
/// The command moves the robot: kTaken or kClipped.
bool isTaken(CommandVerdict verdict) noexcept;

/// A command as it arrived.
struct ArrivedCommand {
  StampedPose pose;       ///< stamp as sent, 0 when it was not set [s]
  std::string frame;      ///< frame_id as sent
  std::string publisher;  ///< name of the sending node
  bool replay = false;    ///< of a latched publisher (LatchedReplay)
};

/// Not thread-safe.
class CommandGate {
 public:
  /// @throws InvalidInput  empty frame, or a number that is negative or not finite
  explicit CommandGate(const CommandGateConfig& config);
  /// Judges one command and makes it what the controller acts on: clipped, and with the stamp at
  /// which it acts (Arrival::actingTime()).
  /// @param now       [s]
  /// @param measured  position of the tool by its encoders, in the base frame [m]
  CommandVerdict judge(double now, const Eigen::Vector3d& measured, ArrivedCommand& command);
  /// Adds to counted(). The caller knows the last word on a command: it may still be kNoIk.
  void count(CommandVerdict verdict) noexcept { ++counts_[static_cast<std::size_t>(verdict)]; }
  /// The controller was started anew.
  void reset() noexcept;
  std::uint64_t counted(CommandVerdict verdict) const noexcept {
    return counts_[static_cast<std::size_t>(verdict)];
  }

 private:
  CommandGateConfig config_;
  Arrival arrival_;
  bool heard_ = false;
  std::array<std::uint64_t, kCommandVerdicts> counts_{};
};

}  // namespace raven_correction
