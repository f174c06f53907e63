// SPDX-License-Identifier: BSD-3-Clause
#include "raven_correction/correction/motion.h"

#include <algorithm>
#include <cmath>

#include "raven_correction/error.h"
#include "raven_correction/geometry/differentiation.h"
#include "raven_correction/robot/chain_file.h"

namespace raven_correction {
namespace {

constexpr int kPlayJoints = 6;
constexpr int kArmJoints = 2;  // revolute ones, before those of the wrist

KinematicChain robotOf(const MotionOptions& options) {
  KinematicChain robot = kinematicChainFromText(options.robot, "robot of the play");
  if (robot.size() != kPlayJoints)
    throw InvalidInput(
        format("robot %s has %d joints; the play of joints is known for robots of %d only",
               robot.name().c_str(), robot.size(), kPlayJoints));
  return robot;
}

}  // namespace

VelocityKind velocityFromName(const std::string& name) {
  for (const VelocityKind kind :
       {VelocityKind::kNone, VelocityKind::kCentral, VelocityKind::kCausal, VelocityKind::kPast})
    if (name == velocityName(kind)) return kind;
  throw InvalidInput(
      format("velocity \"%s\" is not known; one of none, central, causal, past", name.c_str()));
}

const char* velocityName(VelocityKind kind) noexcept {
  switch (kind) {
    case VelocityKind::kNone:
      return "none";
    case VelocityKind::kCentral:
      return "central";
    case VelocityKind::kCausal:
      return "causal";
    case VelocityKind::kPast:
      break;
  }
  return "past";
}

void checkMotionOptions(const MotionOptions& options) {
  if (!(options.window > 0.0) || options.window > 10.0)
    throw InvalidInput(format("velocity window = %g s is outside (0, 10]", options.window));
  if (!(options.max_gap > 0.0) || options.max_gap > 10.0)
    throw InvalidInput(format("max_gap = %g s is outside (0, 10]", options.max_gap));
  if (!(options.play_length >= 0.0) || options.play_length > 1.0 || !(options.play_angle >= 0.0) ||
      options.play_angle > 3.0 || (options.play_length > 0.0) != (options.play_angle > 0.0))
    throw InvalidInput(
        format("play of %g m and %g rad: must be in [0, 1] and [0, 3], and both or "
               "neither zero",
               options.play_length, options.play_angle));
  if (hasJointPlay(options)) {
    const auto angles = {options.joint_play_angle, options.joint_play_wrist};
    if (!(options.joint_play_length > 0.0) || options.joint_play_length > 1.0 ||
        !(std::min(angles) > 0.0) || !(std::max(angles) <= 3.0))
      throw InvalidInput(
          format("play of joints of %g m, %g rad and %g rad (wrist): must be in (0, 1] and (0, 3]",
                 options.joint_play_length, options.joint_play_angle, options.joint_play_wrist));
    robotOf(options);
  }
  if (options.velocity != VelocityKind::kPast) return;
  if (options.intervals.empty() || options.intervals.size() > kMaxTwists)
    throw InvalidInput(
        format("%zu velocity intervals; must be 1 to %zu", options.intervals.size(), kMaxTwists));
  double before = 0.0;
  for (const double begin : options.intervals) {
    if (!(begin > before) || begin > 10.0)
      throw InvalidInput(
          format("velocity interval beginning %g s ago: must increase from above 0 to at most 10 s",
                 begin));
    before = begin;
  }
}

std::size_t twistCount(const MotionOptions& options) noexcept {
  switch (options.velocity) {
    case VelocityKind::kNone:
      return 0;
    case VelocityKind::kCentral:
    case VelocityKind::kCausal:
      return 1;
    case VelocityKind::kPast:
      break;
  }
  return options.intervals.size();
}

bool hasJointPlay(const MotionOptions& options) noexcept { return !options.robot.empty(); }

bool hasPlay(const MotionOptions& options) noexcept {
  return options.play_length > 0.0 || hasJointPlay(options);
}

MotionEstimator::MotionEstimator(const MotionOptions& options)
    : options_(options), samples_(2 * kCapacity) {
  checkMotionOptions(options_);
  const double reach =
      options_.velocity == VelocityKind::kPast ? options_.intervals.back() : options_.window;
  thinning_ = 2.0 * reach / static_cast<double>(kCapacity);
  if (!hasJointPlay(options_)) return;
  const KinematicChain robot = robotOf(options_);
  joints_of_ = std::make_shared<const InverseKinematics>(robot);
  follower_.joints = robot.home();
  play_width_.resize(robot.size());
  int turning = 0;
  for (int j = 0; j < robot.size(); ++j) {
    if (robot.joints()[static_cast<std::size_t>(j)].type == JointType::kPrismatic)
      play_width_(j) = options_.joint_play_length;
    else
      play_width_(j) =
          ++turning <= kArmJoints ? options_.joint_play_angle : options_.joint_play_wrist;
  }
}

void MotionEstimator::startMotion() noexcept {
  started_ = false;
  count_ = 0;
}

void MotionEstimator::reset() noexcept {
  startMotion();
  follower_.dragged = false;
  motion_.joint_play.setZero();
}

void MotionEstimator::takeOver(const MotionEstimator& other) noexcept {
  reset();
  started_ = other.started_;
  last_stamp_ = other.last_stamp_;
  // Joints of another robot, or another width of their play, say nothing of these.
  const bool known = other.follower_.dragged && options_.robot == other.options_.robot &&
                     play_width_ == other.play_width_;
  if (known) follower_ = other.follower_;
  for (std::size_t i = 0; i < other.count_; ++i) {
    const StampedPose& sample = other.samples_[i];
    if (count_ > 0 && sample.stamp - samples_[count_ - 1].stamp > options_.max_gap) count_ = 0;
    remember(sample);
    motion_.pose = sample.pose;
    if (hasPlay(options_) && !known) drag();
  }
}

void MotionEstimator::remember(const StampedPose& sample) noexcept {
  // A burst overwrites the newest place, so that the history always reaches far enough back.
  const bool burst = count_ >= 2 && sample.stamp - samples_[count_ - 2].stamp < thinning_;
  if (burst) {
    --count_;
  } else if (count_ == samples_.size()) {
    std::copy(samples_.begin() + kCapacity, samples_.end(), samples_.begin());
    undo_.count = count_ = kCapacity;
  }
  undo_.place = count_;
  undo_.replaced = samples_[count_];
  samples_[count_++] = sample;
}

void MotionEstimator::undo() noexcept {
  samples_[undo_.place] = undo_.replaced;
  count_ = undo_.count;
  last_stamp_ = undo_.last_stamp;
  started_ = undo_.started;
  motion_ = undo_.motion;
  follower_ = undo_.follower;
}

MotionEstimator::Outcome MotionEstimator::push(double stamp, const Pose& pose) noexcept {
  if (!std::isfinite(stamp) || !isFinite(pose)) return Outcome::kNotFinite;
  if (!hasUnitQuaternion(pose)) return Outcome::kNotUnit;
  if (started_ && stamp < last_stamp_) return Outcome::kBackwards;
  if (started_ && stamp == last_stamp_) return Outcome::kRepeated;
  const double step = started_ ? stamp - last_stamp_ : 0.0;
  undo_.count = count_;
  undo_.last_stamp = last_stamp_;
  undo_.started = started_;
  undo_.motion = motion_;
  undo_.follower = follower_;
  if (step > options_.max_gap) count_ = 0;
  started_ = true;
  last_stamp_ = stamp;
  motion_.pose = {pose.p, pose.q.normalized()};
  motion_.step = step;
  remember({stamp, motion_.pose});
  if (options_.velocity == VelocityKind::kPast)
    pastTwists();
  else if (options_.velocity != VelocityKind::kNone)
    motion_.twists[0] = causalTwist(samples_.data(), count_, options_.window);
  if (hasPlay(options_)) drag();
  return Outcome::kAccepted;
}

void MotionEstimator::drag() noexcept {
  if (joints_of_ != nullptr)
    dragJoints();
  else
    dragPose();
}

void MotionEstimator::dragJoints() noexcept {
  const IkResult now = joints_of_->solve(motion_.pose, follower_.joints);
  if (!reproducesPose(now.status)) return;
  if (!follower_.dragged)
    follower_.slack = JointVector::Zero(now.joints.size());
  else
    follower_.slack += now.joints - follower_.joints;
  follower_.dragged = true;
  follower_.joints = now.joints;
  follower_.slack = follower_.slack.cwiseMax(-play_width_).cwiseMin(play_width_).eval();
  motion_.joint_play = follower_.slack.cwiseQuotient(play_width_);
}

void MotionEstimator::dragPose() noexcept {
  const Pose& pose = motion_.pose;
  if (!follower_.dragged) follower_.pose = pose;
  follower_.dragged = true;
  Displacement& play = motion_.play;
  play = {pose.p - follower_.pose.p, logRotation(pose.q * follower_.pose.q.conjugate())};
  if (const double length = play.p.norm(); length > options_.play_length) {
    play.p *= options_.play_length / length;
    follower_.pose.p = pose.p - play.p;
  }
  if (const double angle = play.r.norm(); angle > options_.play_angle) {
    play.r *= options_.play_angle / angle;
    follower_.pose.q = (expRotation(-play.r) * pose.q).normalized();
  }
}

void MotionEstimator::pastTwists() noexcept {
  const StampedPose& now = samples_[count_ - 1];
  Eigen::Matrix<double, 6, 1> later = Eigen::Matrix<double, 6, 1>::Zero();
  double end = 0.0;
  std::size_t i = count_ - 1;  // the newest sample that is not after the instant
  for (std::size_t k = 0; k < options_.intervals.size(); ++k) {
    const double instant = now.stamp - options_.intervals[k];
    while (i > 0 && samples_[i].stamp > instant) --i;
    const StampedPose& before = samples_[i];
    Eigen::Matrix<double, 6, 1> x;
    x << before.pose.p - now.pose.p, logRotation(before.pose.q * now.pose.q.conjugate());
    if (before.stamp < instant) {
      const StampedPose& after = samples_[i + 1];
      Eigen::Matrix<double, 6, 1> x_after;
      x_after << after.pose.p - now.pose.p, logRotation(after.pose.q * now.pose.q.conjugate());
      x += (instant - before.stamp) / (after.stamp - before.stamp) * (x_after - x);
    }
    const Eigen::Matrix<double, 6, 1> velocity = (later - x) / (options_.intervals[k] - end);
    motion_.twists[k] = {velocity.head<3>(), velocity.tail<3>()};
    later = x;
    end = options_.intervals[k];
  }
}

std::vector<Motion> motionsOf(const PoseStream& stream, const MotionOptions& options) {
  MotionEstimator estimator(options);
  return motionsOf(stream, options, estimator);
}

std::vector<Motion> motionsOf(const PoseStream& stream, const MotionOptions& options,
                              MotionEstimator& estimator) {
  std::vector<Motion> motions;
  motions.reserve(stream.size());
  estimator.startMotion();
  for (const StampedPose& sample : stream) {
    estimator.push(sample.stamp, sample.pose);
    motions.push_back(estimator.motion());
  }
  if (options.velocity != VelocityKind::kCentral) return motions;
  std::size_t first = 0;  // of the motion without long gaps that is being differentiated
  for (std::size_t end = 1; end <= stream.size(); ++end) {
    if (end < stream.size() && stream[end].stamp - stream[end - 1].stamp <= options.max_gap)
      continue;
    const PoseStream motion(stream.begin() + static_cast<std::ptrdiff_t>(first),
                            stream.begin() + static_cast<std::ptrdiff_t>(end));
    for (std::size_t i = first; i < end; ++i)
      motions[i].twists[0] = centralTwist(motion, i - first);
    first = end;
  }
  return motions;
}

}  // namespace raven_correction
