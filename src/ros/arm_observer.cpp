// SPDX-License-Identifier: BSD-3-Clause
#include "raven_correction/ros/arm_observer.h"

#include <Eigen/Geometry>
#include <chrono>
#include <limits>

#include "raven_correction/error.h"
#include "raven_correction/ros/conversions.h"
#include "raven_correction/ros/names.h"
#include "raven_correction/ros/pose_subscription.h"
#include "raven_correction/ros/topics.h"

namespace raven_correction {
namespace {

constexpr double kDrainPeriod = 0.05;       // [s]
constexpr double kCheckPeriod = 2.0;        // [s]
constexpr double kCommanded = 0.5;          // an observation this near to a command counts [s]
constexpr std::size_t kDesired = 2000;      // newest desired poses that are checked [1]
constexpr std::size_t kSpokenFor = 100;     // that are enough for a check: the next ones begin anew
constexpr std::size_t kMostMoves = 500000;  // samples of a stream that are kept [1]
constexpr std::uint32_t kMocapQueue = 2000;

StreamCheckOptions checkOptions(const CorrectorParams& params, const std::string& command,
                                const std::string& mocap) {
  StreamCheckOptions options;
  options.names[static_cast<std::size_t>(StreamRole::kCommands)] = command;
  options.names[static_cast<std::size_t>(StreamRole::kObservations)] = mocap;
  options.base_frame = params.base_frame;
  return options;
}

StreamCheckOptions desiredOptions(const CorrectorParams& params, const ros::NodeHandle& nh) {
  StreamCheckOptions options = checkOptions(params, nh.resolveName(topics::kDesired), "");
  options.window = kDesired;
  return options;
}

}  // namespace

ArmObserver::ArmObserver(const ros::NodeHandle& nh, const CorrectorParams& params,
                         ros::CallbackQueueInterface& check_queue)
    : nh_(nh),
      params_(params),
      mocap_topic_(topics::kMocap),
      desired_(desiredOptions(params, nh)),
      checked_at_(ros::SteadyTime::now()),
      moves_check_(
          checkOptions(params, nh.resolveName(topics::kCommand), nh.resolveName(topics::kMocap))) {
  nh_.setCallbackQueue(&check_queue);
  timer_ = nh_.createWallTimer(ros::WallDuration(kDrainPeriod), [this](const ros::WallTimerEvent&) {
    const std::lock_guard<std::mutex> lock(mutex_);
    drain();
  });
}

ArmObserver::~ArmObserver() { stop(); }

void ArmObserver::stop() {
  const std::lock_guard<std::mutex> lock(mutex_);
  stopping_ = true;
  changed_.notify_all();
}

std::vector<StreamFinding> ArmObserver::findings() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return findings_;
}

void ArmObserver::drain() {
  LiveSample sample;
  const Pose in_base;
  while (queue_.pop(sample)) {
    // No frame is the base frame where that is allowed; anything else is refused by the live path.
    const std::string frame = sample.frame.front() == '\0' && params_.allow_empty_frame
                                  ? params_.base_frame
                                  : sample.frame.data();
    desired_.addPose(StreamRole::kCommands, sample.stamp, sample.arrival, frame, sample.desired,
                     &in_base);
    if (!observing_ || !sample.sent || commands_.size() >= kMostMoves) continue;
    if (!commands_.empty() && sample.stamp <= commands_.back().stamp) commands_.clear();
    commands_.push_back({sample.stamp, sample.command});
    moves_check_.addPose(StreamRole::kCommands, sample.stamp, sample.arrival, frame, sample.command,
                         &in_base);
  }
  const ros::SteadyTime now = ros::SteadyTime::now();
  if ((now - checked_at_).toSec() < kCheckPeriod) return;
  checked_at_ = now;
  findings_ = desired_.findings();
  if (desired_.count(StreamRole::kCommands) >= kSpokenFor) desired_.clear();
}

void ArmObserver::onMocap(const geometry_msgs::PoseStampedConstPtr& message) {
  const std::lock_guard<std::mutex> lock(mutex_);
  if (!observing_ || observations_.size() >= kMostMoves) return;
  drain();
  const double now = ros::Time::now().toSec();
  frame_ = message->header.frame_id.empty() ? params_.mocap_frame : message->header.frame_id;
  StampedPose sample = stampedPoseFromMsg(*message);
  if (params_.mocap_stamp == "receipt") sample.stamp = now;
  const auto X_base_mocap = registration_->find(frame_);
  moves_check_.addPose(StreamRole::kObservations, sample.stamp, now, withoutSlash(frame_),
                       sample.pose, X_base_mocap ? &*X_base_mocap : nullptr);
  if (!X_base_mocap || !(sample.stamp > 0.0)) return;
  registered_ = true;
  sample.pose = *X_base_mocap * sample.pose;
  if (!observations_.empty() && sample.stamp < observations_.back().stamp) return;
  observations_.push_back(sample);
  if (!commands_.empty() && std::abs(sample.stamp - commands_.back().stamp) < kCommanded)
    ++commanded_;
  changed_.notify_all();
}

bool ArmObserver::enough(std::size_t poses, double extent) const {
  if (commanded_ < poses) return false;
  Eigen::AlignedBox3d box;
  for (const StampedPose& command : commands_) box.extend(command.pose.p);
  return !commands_.empty() && box.diagonal().norm() >= extent;
}

ArmObserver::Moves ArmObserver::observe(double duration, std::size_t poses, double extent) {
  using Clock = std::chrono::steady_clock;
  Moves moves;
  const auto refused = [&] {
    if (observing_) moves.problem = "a pre-flight is running; wait until it has returned";
    return observing_;
  };
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (refused()) return moves;
  }
  // It asks the master, which may not answer: never while diagnostics wait for the lock.
  auto listener = std::make_unique<Registration>(params_.base_frame);
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (refused()) return moves;
    drain();  // what came before
    observing_ = true;
    commands_.clear();
    observations_.clear();
    commanded_ = 0;
    registered_ = false;
    frame_.clear();
    moves_check_.clear();
    registration_ = std::move(listener);
  }
  ros::Subscriber mocap;
  try {
    mocap = subscribePose(
        nh_, mocap_topic_, params_.mocap_pose_type, kMocapQueue,
        [this](const geometry_msgs::PoseStampedConstPtr& message) { onMocap(message); });
  } catch (const ros::Exception& error) {  // another part of this process reads it in another type
    const std::lock_guard<std::mutex> lock(mutex_);
    observing_ = false;
    moves.problem = error.what();
    return moves;
  }
  const auto start = Clock::now();
  const auto end = start + std::chrono::duration<double>(duration);
  std::unique_lock<std::mutex> lock(mutex_);
  while (ros::ok() && !stopping_ && Clock::now() < end && !enough(poses, extent))
    changed_.wait_for(lock, std::chrono::milliseconds(100));
  observing_ = false;
  const std::unique_ptr<Registration> registration = std::move(registration_);
  const StreamCheck check = moves_check_;
  moves.commands = std::move(commands_);
  moves.observations = std::move(observations_);
  commands_.clear();
  observations_.clear();
  moves.seconds = std::chrono::duration<double>(Clock::now() - start).count();
  const std::size_t seen = check.count(StreamRole::kObservations);
  if (stopping_ || !ros::ok())
    moves.problem = "the node is being shut down";
  else if (seen == 0)
    moves.problem = format("motion capture is silent: no message on %s within %.1f s",
                           mocap.getTopic().c_str(), moves.seconds);
  else if (!registered_)
    moves.problem = format(
        "tf does not know the frame \"%s\" of %s in %s: start the driver that publishes it, or set "
        "~mocap_frame",
        frame_.c_str(), mocap.getTopic().c_str(), params_.base_frame.c_str());
  else if (moves.commands.empty())
    moves.problem =
        format("no command was sent within %.1f s: let the robot make a few moves", moves.seconds);
  lock.unlock();
  mocap.shutdown();
  moves.findings = check.allFindings();
  return moves;
}

}  // namespace raven_correction
