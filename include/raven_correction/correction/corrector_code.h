// SPDX-License-Identifier: BSD-3-Clause
// What the corrector says of a pose, and what it can be told: codes, limits, modes and holds, with
// their names. What they do to a command is corrector.h.
#pragma once

#include <cstdint>
#include <string>

namespace raven_correction {

/// Numbers as in CorrectionStatus.msg. Below 16 the command is to be sent, from 16 on it is not.
enum class CorrectorCode {
  kCorrected = 0,
  kCorrectedFaded = 1,
  kCorrectedLimited = 2,
  kRigidOnly = 3,
  kPassedOff = 4,
  kPassedNoModel = 5,
  kPassedOutside = 6,
  kPassedModelFault = 7,
  kPassedBetweenEndpoints = 8,
  kPassedNotAbsolute = 9,
  kPassedInactive = 10,
  kPassedRobotNotReady = 11,
  kPassedOtherPublisher = 12,
  kRefusedNotFinite = 16,
  kRefusedNotUnit = 17,
  kRefusedFrame = 18,
  kRefusedZeroStamp = 19,
  kRefusedStale = 20,
  kRefusedFuture = 21,
  kRefusedTimeBackwards = 22,
  kRefusedLatched = 23,
  kRefusedMalformed = 24,
  kRefusedWithOtherArm = 25,
  kRefusedUnreachable = 26,
};
constexpr bool isRefused(CorrectorCode code) noexcept { return static_cast<int>(code) >= 16; }
/// "corrected", "refused_stale", ...
const char* correctorCodeName(CorrectorCode code) noexcept;

enum class CorrectorMode { kOff, kRigid, kFull, kEndpoint };
/// "off", "rigid", "full", "endpoint".
/// @throws InvalidInput  for any other name; the text lists these
CorrectorMode correctorModeFromName(const std::string& name);
const char* correctorModeName(CorrectorMode mode) noexcept;

/// Why nothing is corrected although the mode says so.
enum class CorrectionHold { kNone, kRobotNotReady, kOtherPublisher };

/// What a correction was shortened by; bits as in CorrectionStatus.msg.
enum CorrectorLimit : std::uint8_t {
  kLimitSize = 1,       ///< max_translation, max_rotation
  kLimitRate = 2,       ///< max_translation_rate, max_rotation_rate
  kLimitBox = 4,        ///< box_min, box_max
  kLimitRobotStep = 8,  ///< robot.max_step, robot.max_turn
  kLimitReach = 16,     ///< joints of the robot
  kPlannerBeyond = 32,  ///< the desired pose itself is further from the tool than the robot takes
};

/// What says where the tool is, for the robot's own step.
enum class ToolKnownBy {
  kNotAsked,     ///< no limit of the robot is set
  kMeasured,     ///< its encoders
  kLastCommand,  ///< they are silent: it is taken to be where it was sent last
  kNothing,      ///< nothing was sent yet, either: the robot's step is not limited
};
/// "not asked", "measured_cp", "last command", "nothing".
const char* toolKnownByName(ToolKnownBy by) noexcept;

}  // namespace raven_correction
