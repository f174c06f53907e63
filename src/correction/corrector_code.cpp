// SPDX-License-Identifier: BSD-3-Clause
#include "raven_correction/correction/corrector_code.h"

#include "raven_correction/error.h"

namespace raven_correction {

const char* correctorCodeName(CorrectorCode code) noexcept {
  switch (code) {
    case CorrectorCode::kCorrected:
      return "corrected";
    case CorrectorCode::kCorrectedFaded:
      return "corrected_faded";
    case CorrectorCode::kCorrectedLimited:
      return "corrected_limited";
    case CorrectorCode::kRigidOnly:
      return "rigid_only";
    case CorrectorCode::kPassedOff:
      return "passed_off";
    case CorrectorCode::kPassedNoModel:
      return "passed_no_model";
    case CorrectorCode::kPassedOutside:
      return "passed_outside";
    case CorrectorCode::kPassedModelFault:
      return "passed_model_fault";
    case CorrectorCode::kPassedBetweenEndpoints:
      return "passed_between_endpoints";
    case CorrectorCode::kPassedNotAbsolute:
      return "passed_not_absolute";
    case CorrectorCode::kPassedInactive:
      return "passed_inactive";
    case CorrectorCode::kPassedRobotNotReady:
      return "passed_robot_not_ready";
    case CorrectorCode::kPassedOtherPublisher:
      return "passed_other_publisher";
    case CorrectorCode::kRefusedNotFinite:
      return "refused_not_finite";
    case CorrectorCode::kRefusedNotUnit:
      return "refused_not_unit";
    case CorrectorCode::kRefusedFrame:
      return "refused_frame";
    case CorrectorCode::kRefusedZeroStamp:
      return "refused_zero_stamp";
    case CorrectorCode::kRefusedStale:
      return "refused_stale";
    case CorrectorCode::kRefusedFuture:
      return "refused_future";
    case CorrectorCode::kRefusedTimeBackwards:
      return "refused_time_backwards";
    case CorrectorCode::kRefusedLatched:
      return "refused_latched";
    case CorrectorCode::kRefusedMalformed:
      return "refused_malformed";
    case CorrectorCode::kRefusedWithOtherArm:
      return "refused_with_other_arm";
    case CorrectorCode::kRefusedUnreachable:
      return "refused_unreachable";
  }
  return "unknown";
}

const char* correctorModeName(CorrectorMode mode) noexcept {
  switch (mode) {
    case CorrectorMode::kOff:
      return "off";
    case CorrectorMode::kRigid:
      return "rigid";
    case CorrectorMode::kFull:
      return "full";
    case CorrectorMode::kEndpoint:
      break;
  }
  return "endpoint";
}

CorrectorMode correctorModeFromName(const std::string& name) {
  for (const CorrectorMode mode :
       {CorrectorMode::kOff, CorrectorMode::kRigid, CorrectorMode::kFull, CorrectorMode::kEndpoint})
    if (name == correctorModeName(mode)) return mode;
  throw InvalidInput(
      format("mode \"%s\" is not known; one of off, rigid, full, endpoint", name.c_str()));
}

const char* toolKnownByName(ToolKnownBy by) noexcept {
  switch (by) {
    case ToolKnownBy::kNotAsked:
      return "not asked";
    case ToolKnownBy::kMeasured:
      return "measured_cp";
    case ToolKnownBy::kLastCommand:
      return "last command";
    case ToolKnownBy::kNothing:
      break;
  }
  return "nothing";
}

}  // namespace raven_correction
