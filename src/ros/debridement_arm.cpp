// SPDX-License-Identifier: BSD-3-Clause
#include "raven_correction/ros/debridement_arm.h"

#include <sensor_msgs/JointState.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "raven_correction/TrajectoryEvent.h"
#include "raven_correction/error.h"
#include "raven_correction/ros/conversions.h"
#include "raven_correction/ros/playback.h"
#include "raven_correction/ros/topics.h"

namespace raven_correction {
namespace {

constexpr double kMemory = 3.0;         // of commands and observations [s]
constexpr double kSleep = 5e-4;         // between two looks at a clock that may run fast [s, real]
constexpr double kStartTimeout = 10.0;  // for the first set-point and a listener [s, real]
constexpr double kFirstMeasurement = 0.6;  // commands at rest before the first one [s]
constexpr double kArrival = 0.3;           // of the tool behind its commands, at most [s]
constexpr double kSettleAgain = 0.2;       // after a replanned pose was reached [s]
constexpr double kStatusAge = 0.2;         // of what the corrector says of the last pose [s]
constexpr int kTries = 3;                  // of the first measurement

void forgetBefore(double stamp, PoseStream& stream) {
  const auto old = std::find_if(stream.begin(), stream.end(),
                                [stamp](const StampedPose& s) { return s.stamp >= stamp; });
  // In blocks, so that it is not done for every sample.
  if (old - stream.begin() > 200) stream.erase(stream.begin(), old);
}

}  // namespace

DebridementArm::DebridementArm(const std::string& arm, const std::string& base_frame, FieldEye& eye,
                               const std::atomic<bool>& interrupted)
    : base_frame_(base_frame),
      eye_(eye),
      interrupted_(interrupted),
      replanner_(motion_.replan),
      registration_(base_frame),
      nh_(arm) {
  desired_publisher_ = nh_.advertise<geometry_msgs::PoseStamped>(topics::kDesired, 10);
  jaw_publisher_ = nh_.advertise<sensor_msgs::JointState>(topics::kJawCommand, 10);
  event_publisher_ = nh_.advertise<TrajectoryEvent>(topics::kTrajectoryEvent, 100);
  mocap_subscriber_ = nh_.subscribe<geometry_msgs::PoseStamped>(
      topics::kMocap, 100,
      [this](const geometry_msgs::PoseStampedConstPtr& message) { onMocap(*message); });
  setpoint_subscriber_ = nh_.subscribe<geometry_msgs::PoseStamped>(
      topics::kSetpoint, 1, [this](const geometry_msgs::PoseStampedConstPtr& message) {
        const std::lock_guard<std::mutex> lock(mutex_);
        setpoint_ = poseFromMsg(message->pose);
      });
  status_subscriber_ = nh_.subscribe<CorrectionStatus>(
      topics::kStatus, 100, [this](const CorrectionStatusConstPtr& message) {
        const std::lock_guard<std::mutex> lock(mutex_);
        predicted_ = vectorFromMsg(message->sd_position).norm();
        predicted_stamp_ = message->header.stamp.toSec();
      });
}

void DebridementArm::onMocap(const geometry_msgs::PoseStamped& message) {
  const std::optional<Pose> X_base_mocap = registration_.find(message.header.frame_id);
  if (!X_base_mocap) return;
  const StampedPose seen = stampedPoseFromMsg(message);
  const std::lock_guard<std::mutex> lock(mutex_);
  if (!observed_.empty() && seen.stamp < observed_.back().stamp) return;
  observed_.push_back({seen.stamp, *X_base_mocap * seen.pose});
  forgetBefore(seen.stamp - kMemory, observed_);
}

void DebridementArm::use(const ArmMotion& motion) {
  motion_ = motion;
  // The arm stays where it is told to be: what was undone so far becomes part of the desired pose.
  if (desired_) desired_ = replanner_.command(*desired_, now());
  replanner_ = DeviationReplanner(motion.replan);
  next_replan_ = 0.0;
  measurements_ = 0;
}

double DebridementArm::now() { return ros::Time::now().toSec(); }

Pose DebridementArm::start() {
  if (desired_) return *desired_;
  const ros::SteadyTime deadline = ros::SteadyTime::now() + ros::WallDuration(kStartTimeout);
  for (;;) {
    {
      const std::lock_guard<std::mutex> lock(mutex_);
      if (setpoint_ && desired_publisher_.getNumSubscribers() > 0) return *setpoint_;
    }
    if (interrupted_ || !ros::ok() || ros::SteadyTime::now() > deadline)
      throw std::runtime_error(nh_.getNamespace() +
                               ": no set-point, or nobody listens to desired poses");
    ros::WallDuration(0.01).sleep();
  }
}

void DebridementArm::send(const StampedPose& desired) {
  const Pose command = replanner_.command(desired.pose, desired.stamp);
  desired_publisher_.publish(stampedPoseToMsg(desired.stamp, command, base_frame_));
  jaw_publisher_.publish(
      jointsToMsg(desired.stamp, {"jaw"}, Eigen::VectorXd::Constant(1, opening_)));
  desired_ = desired.pose;
  last_stamp_ = desired.stamp;
  sent_.push_back({desired.stamp, command});
  forgetBefore(desired.stamp - kMemory, sent_);
  if (motion_.replan_interval <= 0.0 || desired.stamp < next_replan_) return;
  next_replan_ = desired.stamp + motion_.replan_interval;
  measure(desired.stamp);
}

PoseStream DebridementArm::seenSince(double stamp) {
  PoseStream recent;
  const std::lock_guard<std::mutex> lock(mutex_);
  for (const StampedPose& sample : observed_)
    if (sample.stamp >= stamp) recent.push_back(sample);
  return recent;
}

bool DebridementArm::measure(double at) {
  const bool measured = replanner_.measure(sent_, seenSince(at - motion_.window), at);
  if (measured) ++measurements_;
  return measured;
}

void DebridementArm::stream(PoseStream motion) {
  Playback playback(std::move(motion), std::max(now(), last_stamp_ + 1.0 / motion_.rate),
                    1.0 / motion_.rate);
  while (!playback.finished()) {
    if (interrupted_ || !ros::ok()) throw std::runtime_error("interrupted");
    if (const std::optional<StampedPose> desired = playback.next(now()))
      send(*desired);
    else
      ros::WallDuration(kSleep).sleep();
  }
}

void DebridementArm::announce(const char* kind, bool begins, double stamp, const Pose& target) {
  TrajectoryEvent event;
  event.header.stamp.fromSec(stamp);
  event.trajectory = format("d%04u", motions_);
  event.kind = kind;
  event.event = begins ? TrajectoryEvent::START : TrajectoryEvent::END;
  event.target = poseToMsg(target);
  event_publisher_.publish(event);
}

void DebridementArm::move(const char* kind, const Pose& X_base_tool, double dwell) {
  const Pose from = start();
  // A deviation that was measured at a place is not that of another.
  if (motion_.replan_interval <= 0.0) replanner_.forget(now());
  const double period = 1.0 / motion_.rate;
  PoseStream motion = smoothMove(from, X_base_tool, motion_.speed, motion_.angular_speed,
                                 motion_.acceleration, period);
  for (double t = period; t <= dwell; t += period)
    motion.push_back({motion.back().stamp + period, X_base_tool});
  announce(kind, true, std::max(now(), last_stamp_ + period), X_base_tool);
  stream(std::move(motion));
  announce(kind, false, last_stamp_, X_base_tool);
  ++motions_;
}

void DebridementArm::wait(double duration) {
  const Pose here = start();
  PoseStream motion{{0.0, here}};
  for (double t = 1.0 / motion_.rate; t <= duration; t += 1.0 / motion_.rate)
    motion.push_back({t, here});
  stream(std::move(motion));
}

void DebridementArm::setJaw(double opening, double dwell) {
  opening_ = opening;
  if (dwell > 0.0) wait(dwell);
}

FieldPicture DebridementArm::look() {
  return eye_.look([this] { wait(motion_.look_time); });
}

double DebridementArm::predictedDeviation() {
  const std::lock_guard<std::mutex> lock(mutex_);
  // Of another pose it says nothing of this one.
  return last_stamp_ - predicted_stamp_ <= kStatusAge ? predicted_
                                                      : std::numeric_limits<double>::infinity();
}

bool DebridementArm::replanHere() {
  // With friction and play the tool does not go all of the way that undoes a deviation.
  for (unsigned i = 0; i < motion_.replans_at_rest; ++i) {
    wait(kArrival + motion_.window);  // the tool comes to rest after what it was sent
    const Eigen::Vector3d before = replanner_.translation();
    if (!measure(last_stamp_)) return i > 0;
    wait(motion_.replan.blend + kSettleAgain);
    if ((replanner_.translation() - before).norm() < motion_.near_enough) break;
  }
  return true;
}

void DebridementArm::measureAtRest() {
  for (int i = 0; i < kTries; ++i) {
    wait(kFirstMeasurement);
    if (replanHere()) return;
  }
  throw std::runtime_error(nh_.getNamespace() +
                           ": motion capture does not say where the tool at rest is");
}

void DebridementArm::takeBack() {
  replanner_.forget(now());
  wait(motion_.replan.blend + kSettleAgain);
}

std::optional<Eigen::Vector3d> DebridementArm::deviation() {
  DeviationReplanner probe({});  // which takes whatever it sees
  if (!desired_ || !probe.measure(sent_, seenSince(last_stamp_ - motion_.window), last_stamp_))
    return std::nullopt;
  // What it is off from what was sent, and that from what was asked for.
  return probe.translation() + sent_.back().pose.p - desired_->p;
}

}  // namespace raven_correction
