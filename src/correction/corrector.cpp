// SPDX-License-Identifier: BSD-3-Clause
#include "raven_correction/correction/corrector.h"

#include <cmath>

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

namespace {

void checkLimits(const CorrectorLimits& limits) {
  const struct {
    const char* name;
    double value;
  } positive[] = {{"max_translation", limits.max_translation},
                  {"max_rotation", limits.max_rotation},
                  {"max_translation_rate", limits.max_translation_rate},
                  {"max_rotation_rate", limits.max_rotation_rate},
                  {"max_step_time", limits.max_step_time}};
  for (const auto& limit : positive)
    if (!(limit.value > 0.0) || !std::isfinite(limit.value))
      throw InvalidInput(
          format("corrector: %s = %g must be > 0 and finite", limit.name, limit.value));
  const bool no_box = limits.box_min.isZero(0.0) && limits.box_max.isZero(0.0);
  if (!no_box && !(limits.box_min.array() < limits.box_max.array()).all())
    throw InvalidInput(format(
        "corrector: box from (%g, %g, %g) to (%g, %g, %g) m: every min must be below its max; all "
        "six zero: no box",
        limits.box_min.x(), limits.box_min.y(), limits.box_min.z(), limits.box_max.x(),
        limits.box_max.y(), limits.box_max.z()));
  if (!(limits.max_age >= 0.0) || !(limits.max_ahead >= 0.0))
    throw InvalidInput(format("corrector: max_age = %g s and max_ahead = %g s must be >= 0",
                              limits.max_age, limits.max_ahead));
}

/// Shortens v to `longest`; says whether it had to.
bool shorten(Eigen::Vector3d& v, double longest) noexcept {
  const double length = v.norm();
  if (!(length > longest)) return false;
  v *= longest / length;
  return true;
}

/// Moves `current` towards `wanted` by at most `step`; says whether it fell short.
bool approach(Eigen::Vector3d& current, const Eigen::Vector3d& wanted, double step) noexcept {
  Eigen::Vector3d change = wanted - current;
  if (!shorten(change, step)) {
    current = wanted;  // exactly, so that a correction of zero is zero
    return false;
  }
  current += change;
  return true;
}

}  // namespace

Corrector::Corrector(const CorrectorLimits& limits)
    : limits_(limits), has_box_(!limits.box_min.isZero(0.0) || !limits.box_max.isZero(0.0)) {
  checkLimits(limits);
}

void Corrector::setModel(const Correction& model) {
  models_.push_back(std::make_unique<Live>(model));
  live_.store(models_.back().get(), std::memory_order_release);
}

void Corrector::restart() noexcept {
  started_ = false;
  if (Live* const live = live_.load(std::memory_order_acquire)) live->estimator.reset();
}

/// Shortens the correction, axis by axis, where it would leave the box, or leave it further than
/// the desired pose does: continuous, and zero stays zero.
bool Corrector::keepInBox(const Eigen::Vector3d& desired,
                          Eigen::Vector3d& translation) const noexcept {
  if (!has_box_) return false;
  const Eigen::Vector3d low = limits_.box_min.cwiseMin(desired) - desired;
  const Eigen::Vector3d high = limits_.box_max.cwiseMax(desired) - desired;
  const Eigen::Vector3d inside = translation.cwiseMax(low).cwiseMin(high);
  const bool limited = inside != translation;
  translation = inside;
  return limited;
}

/// The pose that the mode wants, before limits, and why.
CorrectorOutput Corrector::aim(Live* live, const Pose& desired, bool endpoint,
                               Pose& wanted) noexcept {
  CorrectorOutput output;
  wanted = desired;
  const CorrectorMode mode = mode_.load(std::memory_order_relaxed);
  if (mode == CorrectorMode::kOff) {
    output.code = CorrectorCode::kPassedOff;
    return output;
  }
  if (live == nullptr) {
    output.code = CorrectorCode::kPassedNoModel;
    return output;
  }
  if (mode == CorrectorMode::kEndpoint && !endpoint) {
    output.code = CorrectorCode::kPassedBetweenEndpoints;
    return output;
  }
  const Prediction prediction = live->predictor.predict(live->estimator.motion(), *live->workspace);
  output.model = &live->predictor.model().id;
  output.sd_position = prediction.sd_position;
  output.sd_rotation = prediction.sd_rotation;
  output.h_share = prediction.h_share * prediction.g_share;
  if (prediction.status == Prediction::Status::kModelFault) {
    output.code = CorrectorCode::kPassedModelFault;
    output.h_share = 0.0;
    return output;
  }
  wanted = prediction.command;
  output.code = CorrectorCode::kCorrected;
  if (mode == CorrectorMode::kRigid) {
    wanted = prediction.g_share == 1.0 ? prediction.rigid
                                       : interpolate(desired, prediction.rigid, prediction.g_share);
    output.h_share = 0.0;
    output.code = CorrectorCode::kRigidOnly;
  }
  if (prediction.g_share == 0.0)
    output.code = CorrectorCode::kPassedOutside;
  else if (prediction.g_share < 1.0 || (prediction.h_share < 1.0 && mode != CorrectorMode::kRigid))
    output.code = CorrectorCode::kCorrectedFaded;
  return output;
}

CorrectorOutput Corrector::correct(double stamp, double now, const Pose& desired,
                                   bool endpoint) noexcept {
  CorrectorOutput output;
  output.command = desired;
  const auto refuse = [&](CorrectorCode code) {
    output.code = code;
    return output;
  };
  if (!std::isfinite(stamp) || !isFinite(desired)) return refuse(CorrectorCode::kRefusedNotFinite);
  if (!hasUnitQuaternion(desired)) return refuse(CorrectorCode::kRefusedNotUnit);
  if (!(stamp > 0.0)) return refuse(CorrectorCode::kRefusedZeroStamp);
  if (limits_.max_age > 0.0 && !(now - stamp <= limits_.max_age))
    return refuse(CorrectorCode::kRefusedStale);
  if (limits_.max_ahead > 0.0 && !(stamp - now <= limits_.max_ahead))
    return refuse(CorrectorCode::kRefusedFuture);
  if (started_ && !(stamp > last_stamp_)) return refuse(CorrectorCode::kRefusedTimeBackwards);

  Live* const live = live_.load(std::memory_order_acquire);
  // The estimator of a new model starts with its first pose, as at the start of a motion.
  if (live != nullptr) live->estimator.push(stamp, desired);
  Pose wanted;
  output = aim(live, desired, endpoint, wanted);

  Eigen::Vector3d translation = wanted.p - desired.p;
  Eigen::Vector3d rotation = logRotation(desired.q.conjugate() * wanted.q);
  bool limited = shorten(translation, limits_.max_translation);
  limited |= shorten(rotation, limits_.max_rotation);
  // The first pose of all may be corrected by as much as one after a long silence.
  const double elapsed =
      started_ ? std::min(stamp - last_stamp_, limits_.max_step_time) : limits_.max_step_time;
  limited |= approach(translation_, translation, limits_.max_translation_rate * elapsed);
  limited |= approach(rotation_, rotation, limits_.max_rotation_rate * elapsed);
  limited |= keepInBox(desired.p, translation_);
  started_ = true;
  last_stamp_ = stamp;

  output.command = desired;
  if (!translation_.isZero(0.0)) output.command.p += translation_;
  if (!rotation_.isZero(0.0)) output.command.q = (desired.q * expRotation(rotation_)).normalized();
  if (limited) output.code = CorrectorCode::kCorrectedLimited;
  return output;
}

}  // namespace raven_correction
