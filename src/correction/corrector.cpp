// SPDX-License-Identifier: BSD-3-Clause
#include "raven_correction/correction/corrector.h"

#include <cmath>

#include "raven_correction/error.h"

namespace raven_correction {
namespace {

void checkLimits(const CorrectorLimits& limits) {
  const struct {
    const char* name;
    double value;
  } positive[] = {{"max_translation", limits.max_translation},
                  {"max_rotation", limits.max_rotation},
                  {"max_translation_rate", limits.max_translation_rate},
                  {"max_rotation_rate", limits.max_rotation_rate},
                  {"max_step_time", limits.max_step_time},
                  {"max_measured_age", limits.max_measured_age}};
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

/// Remembers poses 2 ms apart for at least 2 s.
MotionOptions untilThereIsAModel() {
  MotionOptions options;
  options.velocity = VelocityKind::kNone;
  options.window = 1.0;
  options.max_gap = 10.0;  // what a gap is, a model says
  return options;
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
    : limits_(limits),
      has_box_(!limits.box_min.isZero(0.0) || !limits.box_max.isZero(0.0)),
      reach_(limits.robot),
      max_translation_(limits.max_translation),
      max_rotation_(limits.max_rotation),
      before_models_(untilThereIsAModel()) {
  checkLimits(limits);
}

void Corrector::setTuning(double gain, double max_translation, double max_rotation) {
  if (!(gain >= 0.0 && gain <= 1.0))
    throw InvalidInput(format("corrector: gain = %g is outside [0, 1]", gain));
  CorrectorLimits limits = limits_;
  limits.max_translation = max_translation;
  limits.max_rotation = max_rotation;
  checkLimits(limits);
  gain_.store(gain, std::memory_order_relaxed);
  max_translation_.store(max_translation, std::memory_order_relaxed);
  max_rotation_.store(max_rotation, std::memory_order_relaxed);
}

void Corrector::setMeasured(double stamp, double now, const Pose& measured) noexcept {
  if (!isFinite(measured) || !hasUnitQuaternion(measured)) return;
  if (!(stamp > 0.0) || !(stamp > measured_at_)) return;
  if (!(stamp - now <= limits_.max_measured_age)) return;
  measured_ = measured;
  measured_at_ = stamp;
}

void Corrector::setModel(const Correction& model) {
  auto live = std::make_unique<Live>(model);
  if (!models_.empty() && models_.back()->predictor.model().id == model.id) return;
  models_.push_back(std::move(live));
  live_.store(models_.back().get(), std::memory_order_release);
}

void Corrector::restart() noexcept {
  discard();
  stream_.started = false;
  stream_.commanded = false;
  measured_at_ = -std::numeric_limits<double>::infinity();
  follower_->reset();
  stream_.ahead = nullptr;
}

std::optional<double> Corrector::modelDelay() const noexcept {
  const Live* const live = live_.load(std::memory_order_acquire);
  if (live == nullptr) return std::nullopt;
  return live->predictor.model().delay;
}

/// What a hold takes back while no pose comes. Its end is not timed: all of the silence counts, so
/// that a correction is never there again after a robot was homed.
void Corrector::takeBackAfterHold(double stamp) noexcept {
  held_seen_ = held_.load();
  if (!held_seen_) return;
  const double silence =
      next_.started ? stamp - next_.last_stamp : std::numeric_limits<double>::infinity();
  const double uncounted = silence - limits_.max_step_time;  // correct() counts the rest
  if (!(uncounted > 0.0)) return;
  approach(next_.translation, Eigen::Vector3d::Zero(), limits_.max_translation_rate * uncounted);
  approach(next_.rotation, Eigen::Vector3d::Zero(), limits_.max_rotation_rate * uncounted);
  next_.commanded = false;  // who knows where the tool is now
}

/// Shortens the correction in force where it would take the command out of the box, or further from
/// the tool than the robot takes; or further than the desired pose is: continuous, and zero stays
/// zero. Of a part that is not asked for nothing is known, and nothing is limited.
void Corrector::keepWithinLimits(double now, Pose desired, bool position, bool orientation,
                                 CorrectorOutput& output) noexcept {
  const bool measured = std::abs(now - measured_at_) <= limits_.max_measured_age;
  const Pose* const tool = measured ? &measured_ : next_.commanded ? &next_.last_command : nullptr;
  if (!position) desired.p = tool != nullptr ? tool->p : Eigen::Vector3d::Zero();
  if (!orientation) desired.q = tool != nullptr ? tool->q : Eigen::Quaterniond::Identity();
  constexpr double kEverywhere = std::numeric_limits<double>::infinity();
  Eigen::AlignedBox3d room(Eigen::Vector3d::Constant(-kEverywhere),
                           Eigen::Vector3d::Constant(kEverywhere));
  if (has_box_) room = {limits_.box_min.cwiseMin(desired.p), limits_.box_max.cwiseMax(desired.p)};
  Pose corrected = desired;
  if (position) corrected.p += next_.translation;
  if (orientation) corrected.q = corrected.q * expRotation(next_.rotation);
  const NearTool near = keepNear(limits_.robot, tool, room, desired, corrected);
  if (near.shortened_position || near.shortened_room)
    next_.translation = near.command.p - desired.p;
  if (near.shortened_orientation)
    next_.rotation = logRotation(desired.q.conjugate() * near.command.q);
  if (near.shortened_room) output.limits |= kLimitBox;
  if (near.shortened_position || near.shortened_orientation) output.limits |= kLimitRobotStep;
  if (near.desired_beyond) output.limits |= kPlannerBeyond;
  if (limits_.robot.max_step > 0.0 || limits_.robot.max_turn > 0.0)
    output.tool_known_by = measured          ? ToolKnownBy::kMeasured
                           : tool != nullptr ? ToolKnownBy::kLastCommand
                                             : ToolKnownBy::kNothing;
}

/// What all answers begin with.
CorrectorOutput Corrector::answer() const noexcept {
  CorrectorOutput output;
  output.mode = mode_.load(std::memory_order_relaxed);
  output.gain = gain_.load(std::memory_order_relaxed);
  return output;
}

/// The pose that the mode wants, before limits, and why.
void Corrector::aim(Live* live, const Pose& desired, bool endpoint, const Motion* ahead,
                    Pose& wanted, CorrectorOutput& output) noexcept {
  wanted = desired;
  const CorrectorMode mode = output.mode;
  if (mode == CorrectorMode::kOff) {
    output.code = CorrectorCode::kPassedOff;
    return;
  }
  const CorrectionHold hold = hold_.load(std::memory_order_relaxed);
  if (hold != CorrectionHold::kNone) {
    output.code = hold == CorrectionHold::kRobotNotReady ? CorrectorCode::kPassedRobotNotReady
                                                         : CorrectorCode::kPassedOtherPublisher;
    return;
  }
  if (live == nullptr) {
    output.code = CorrectorCode::kPassedNoModel;
    return;
  }
  const Correction& model = live->predictor.model();
  output.distance = distanceFromWorkspace(desired.p, model.trust);
  if (mode == CorrectorMode::kEndpoint && !endpoint) {
    output.code = CorrectorCode::kPassedBetweenEndpoints;
    return;
  }
  Prediction prediction;
  if (ahead != nullptr && mode != CorrectorMode::kEndpoint) {
    prediction = live->predictor.predict(*ahead, *live->workspace);
    // Where the correction fades to the planner's own pose, that is the one of now.
    output.ahead =
        prediction.g_share == 1.0 && prediction.status != Prediction::Status::kModelFault;
  }
  if (!output.ahead)
    prediction = live->predictor.predict(live->estimator.motion(), *live->workspace);
  output.model = &model.id;
  output.sd_position = prediction.sd_position;
  output.sd_rotation = prediction.sd_rotation;
  output.h_share = prediction.h_share * prediction.g_share;
  if (prediction.status == Prediction::Status::kModelFault) {
    output.code = CorrectorCode::kPassedModelFault;
    output.h_share = 0.0;
    return;
  }
  wanted = prediction.command;
  output.code = CorrectorCode::kCorrected;
  const bool rigid_only =
      mode == CorrectorMode::kRigid || (model.process.groups.empty() && model.physics.empty());
  if (rigid_only) {
    wanted = prediction.g_share == 1.0 ? prediction.rigid
                                       : interpolate(desired, prediction.rigid, prediction.g_share);
    output.h_share = 0.0;
    output.code = CorrectorCode::kRigidOnly;
  }
  if (prediction.g_share == 0.0)
    output.code = CorrectorCode::kPassedOutside;
  else if (prediction.g_share < 1.0 ||
           (prediction.status == Prediction::Status::kFaded && !rigid_only))
    output.code = CorrectorCode::kCorrectedFaded;
}

std::optional<CorrectorCode> Corrector::fault(double stamp, double now,
                                              const Pose& desired) const noexcept {
  if (!std::isfinite(stamp) || !isFinite(desired)) return CorrectorCode::kRefusedNotFinite;
  if (!hasUnitQuaternion(desired)) return CorrectorCode::kRefusedNotUnit;
  if (!(stamp > 0.0)) return CorrectorCode::kRefusedZeroStamp;
  if (limits_.max_age > 0.0 && !(now - stamp <= limits_.max_age))
    return CorrectorCode::kRefusedStale;
  if (limits_.max_ahead > 0.0 && !(stamp - now <= limits_.max_ahead))
    return CorrectorCode::kRefusedFuture;
  if (stream_.started && !(stamp > stream_.last_stamp)) return CorrectorCode::kRefusedTimeBackwards;
  return std::nullopt;
}

/// The last prepare() was not committed: as if it had never been.
void Corrector::discard() noexcept {
  if (!prepared_) return;
  prepared_ = false;
  if (followed_ != nullptr) followed_->undo();
  if (followed_ahead_ != nullptr) followed_ahead_->undo();
  reach_.discard();
}

/// Each model has its own way of telling a motion, but there is one motion.
void Corrector::follow(MotionEstimator& follower, double stamp, const Pose& desired) noexcept {
  if (&follower != follower_) follower.takeOver(*follower_);
  follower_ = &follower;
  const bool accepted = follower.push(stamp, desired) == MotionEstimator::Outcome::kAccepted;
  followed_ = accepted ? &follower : nullptr;
}

/// The motion up to the pose ahead: what was, and then what is announced. Null where nothing is.
const Motion* Corrector::followAhead(Live* live, const Lookahead* ahead) noexcept {
  followed_ahead_ = next_.ahead = nullptr;
  if (live == nullptr || ahead == nullptr) return nullptr;
  if (stream_.ahead != &live->ahead) live->ahead.takeOver(live->estimator);
  if (live->ahead.push(ahead->stamp, ahead->pose) != MotionEstimator::Outcome::kAccepted)
    return nullptr;
  followed_ahead_ = next_.ahead = &live->ahead;
  return &live->ahead.motion();
}

void Corrector::commit() noexcept {
  if (!prepared_) return;
  prepared_ = false;
  stream_ = next_;
  reach_.commit();
  if (!held_seen_) return;
  held_.store(false);
  if (hold_.load() != CorrectionHold::kNone) held_.store(true);  // and goes on after this pose
}

/// The first pose of all may be corrected by as much as one after a long silence. [s]
double Corrector::stepTime(double stamp) const noexcept {
  return next_.started ? std::min(stamp - next_.last_stamp, limits_.max_step_time)
                       : limits_.max_step_time;
}

CorrectorOutput Corrector::prepareParts(double stamp, double now, const Pose& desired,
                                        bool position, bool orientation) noexcept {
  discard();
  CorrectorOutput output = answer();
  output.code = CorrectorCode::kPassedNotAbsolute;
  output.command = desired;
  next_ = stream_;
  followed_ = followed_ahead_ = next_.ahead = nullptr;
  takeBackAfterHold(stamp);
  const double elapsed = stepTime(stamp);
  const Eigen::Vector3d none = Eigen::Vector3d::Zero();
  if (position && approach(next_.translation, none, limits_.max_translation_rate * elapsed))
    output.limits |= kLimitRate;
  if (orientation && approach(next_.rotation, none, limits_.max_rotation_rate * elapsed))
    output.limits |= kLimitRate;
  keepWithinLimits(now, desired, position, orientation, output);
  if (position && !next_.translation.isZero(0.0)) output.command.p += next_.translation;
  if (orientation && !next_.rotation.isZero(0.0))
    output.command.q = (desired.q * expRotation(next_.rotation)).normalized();
  if ((output.limits & ~kPlannerBeyond) != 0) output.code = CorrectorCode::kCorrectedLimited;
  next_.started = true;
  next_.last_stamp = stamp;
  next_.commanded = false;  // where the tool goes is not known
  prepared_ = true;
  return output;
}

CorrectorOutput Corrector::prepare(double stamp, double now, const Pose& desired, bool endpoint,
                                   const Lookahead* ahead) noexcept {
  discard();
  CorrectorOutput output = answer();
  output.command = desired;
  if (const auto code = fault(stamp, now, desired)) {
    output.code = *code;
    return output;
  }

  next_ = stream_;
  takeBackAfterHold(stamp);
  reach_.follow(desired);
  Live* const live = live_.load(std::memory_order_acquire);
  follow(live != nullptr ? live->estimator : before_models_, stamp, desired);
  const Motion* const motion_ahead = followAhead(live, ahead);
  Pose wanted;
  aim(live, desired, endpoint, motion_ahead, wanted, output);

  Eigen::Vector3d translation = output.gain * (wanted.p - desired.p);
  Eigen::Vector3d rotation = output.gain * logRotation(desired.q.conjugate() * wanted.q);
  if (shorten(translation, max_translation_.load(std::memory_order_relaxed)))
    output.limits |= kLimitSize;
  if (shorten(rotation, max_rotation_.load(std::memory_order_relaxed))) output.limits |= kLimitSize;
  if (reach_.isChecked() && !(translation.isZero(0.0) && rotation.isZero(0.0))) {
    const double share = reach_.reachableShare(translation, rotation);
    translation *= share;
    rotation *= share;
    if (share < 1.0) output.limits |= kLimitReach;
  }
  const double elapsed = stepTime(stamp);
  if (approach(next_.translation, translation, limits_.max_translation_rate * elapsed))
    output.limits |= kLimitRate;
  if (approach(next_.rotation, rotation, limits_.max_rotation_rate * elapsed))
    output.limits |= kLimitRate;
  keepWithinLimits(now, desired, true, true, output);
  next_.started = true;
  next_.last_stamp = stamp;
  prepared_ = true;

  const bool corrected = !(next_.translation.isZero(0.0) && next_.rotation.isZero(0.0));
  if (!next_.translation.isZero(0.0)) output.command.p += next_.translation;
  if (!next_.rotation.isZero(0.0))
    output.command.q = (desired.q * expRotation(next_.rotation)).normalized();
  if ((output.limits & ~kPlannerBeyond) != 0) output.code = CorrectorCode::kCorrectedLimited;
  if (corrected && !reach_.reaches(output.command)) {
    output.code = CorrectorCode::kRefusedUnreachable;
    return output;
  }
  next_.last_command = output.command;
  next_.commanded = true;
  return output;
}

}  // namespace raven_correction
