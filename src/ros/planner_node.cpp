// SPDX-License-Identifier: BSD-3-Clause
#include "raven_correction/ros/planner_node.h"

#include <geometry_msgs/PoseArray.h>

#include <algorithm>
#include <cmath>

#include "raven_correction/TrajectoryEvent.h"
#include "raven_correction/error.h"
#include "raven_correction/robot/chain_file.h"
#include "raven_correction/ros/conversions.h"
#include "raven_correction/ros/params.h"
#include "raven_correction/ros/topics.h"

namespace raven_correction {
namespace {

constexpr double kLongestSleep = 0.01;    // between two looks at the stop flag, real time [s]
constexpr double kSimulatedSleep = 5e-4;  // between two looks at a clock that may run fast [s]
constexpr double kSamePosition = 1e-3;    // a set-point that moved further was moved by others [m]
constexpr double kSameAngle = 0.01;       // the same for its orientation [rad]
constexpr unsigned kReports = 10;         // progress lines in the log per run

double now() { return ros::Time::now().toSec(); }

/// Waits in real time, so that a clock that stands still does not wait for ever.
bool waitFor(const std::function<bool()>& condition, double timeout) {
  const ros::SteadyTime deadline = ros::SteadyTime::now() + ros::WallDuration(timeout);
  while (!condition()) {
    if (!ros::ok() || ros::SteadyTime::now() > deadline) return false;
    ros::WallDuration(kLongestSleep).sleep();
  }
  return true;
}

void sleepUntil(double due) {
  const double left = due - now();
  const double longest = ros::Time::isSimTime() ? kSimulatedSleep : kLongestSleep;
  if (left > 0.0) ros::WallDuration(std::min(left, longest)).sleep();
}

void readVector(ParamReader& read, const char* name, Eigen::Vector3d& value, double min,
                double max) {
  std::vector<double> list(value.data(), value.data() + 3);
  read.numbers(name, list, 3, min, max);
  value = Eigen::Map<const Eigen::Vector3d>(list.data());
}

}  // namespace

PlannerParams loadPlannerParams(const ros::NodeHandle& nh) {
  PlannerParams params;
  DebridementConfig& motion = params.motion;
  std::string kind = "fragments";
  ParamReader read(nh, "planner");
  read.requiredText("robot", params.robot, "set it to a file of the package's config/robots");
  read.text("base_frame", params.base_frame);
  read.oneOf("motion", kind, {"fragments", "debridement"});
  readVector(read, "field_centre", motion.field_centre, -1.0, 1.0);
  readVector(read, "field_size", motion.field_size, 0.0, 1.0);
  readVector(read, "receptacle", motion.receptacle, -1.0, 1.0);
  readVector(read, "box_lower", motion.box_lower, -1.0, 1.0);
  readVector(read, "box_upper", motion.box_upper, -1.0, 1.0);
  std::vector<double> xyzw(motion.orientation.coeffs().data(),
                           motion.orientation.coeffs().data() + 4);
  read.numbers("orientation", xyzw, 4, -1.0, 1.0);
  readVector(read, "orientation_deviation", motion.orientation_deviation, 0.0, 1.0);
  for (const DebridementField& field : debridementFields())
    read.number(field.key, motion.*field.value, field.lower, field.upper);
  read.number("silence", params.silence, 0.0, 10.0);
  read.number("stop_time", params.stop_time, 0.0, 5.0);
  read.positive("start_timeout", params.start_timeout, 60.0);
  read.refuseUnknownKeys();
  read.throwIfAnyProblem();
  params.debridement = kind == "debridement";
  motion.orientation = Eigen::Quaterniond(xyzw[3], xyzw[0], xyzw[1], xyzw[2]);
  if (!(std::abs(motion.orientation.norm() - 1.0) <= kUnitTolerance))
    throw InvalidInput(
        format("planner: ~orientation has length %g, must be 1; it is a quaternion x, y, z, w",
               motion.orientation.norm()));
  motion.orientation.normalize();
  ROS_INFO_STREAM(read.summary());
  return params;
}

PlannerNode::PlannerNode(const ros::NodeHandle& nh, const ros::NodeHandle& private_nh,
                         const PlannerParams& params)
    : params_(params), robot_(loadKinematicChain(params.robot)), nh_(nh) {
  DebridementMotion(params_.motion, robot_, 0).randomTarget();  // refuse a bad field now, not later
  ros::NodeHandle private_handle(private_nh);
  desired_ = nh_.advertise<geometry_msgs::PoseStamped>(topics::kDesired, 10);
  jaw_ = nh_.advertise<sensor_msgs::JointState>(topics::kJawCommand, 10);
  path_ = nh_.advertise<geometry_msgs::PoseArray>(topics::kDesiredPath, 10);
  event_ = nh_.advertise<TrajectoryEvent>(topics::kTrajectoryEvent, 100);
  progress_ = private_handle.advertise<WorkProgress>("progress", 1, true);
  setpoint_subscriber_ = nh_.subscribe<geometry_msgs::PoseStamped>(
      topics::kSetpoint, 1, [this](const geometry_msgs::PoseStampedConstPtr& msg) {
        const std::lock_guard<std::mutex> lock(mutex_);
        setpoint_ = poseFromMsg(msg->pose);
      });
  progress(WorkProgress::IDLE, "", 0.0, -1.0, "waiting for a call of ~run");
  run_ = private_handle.advertiseService("run", &PlannerNode::onRun, this);
  stop_service_ = private_handle.advertiseService("stop", &PlannerNode::onStop, this);
  ROS_INFO("planning for %s on %s, in %s", robot_.name().c_str(), desired_.getTopic().c_str(),
           params_.base_frame.c_str());
}

bool PlannerNode::onRun(RunPlanner::Request& request, RunPlanner::Response& response) {
  if (running_.exchange(true)) {
    response.success = false;
    response.message = "a run is going on; call stop first, or wait for its end";
    return true;
  }
  stop_ = false;
  const double start = now();
  Outcome outcome;
  try {
    outcome = runMotions(request);
  } catch (const InvalidInput& error) {
    outcome.message = error.what();
  }
  response.success = outcome.success;
  response.message = outcome.message;
  response.trajectories = outcome.completed;
  response.duration = now() - start;
  const std::size_t asked = request.targets.empty() ? request.trajectories : request.targets.size();
  const double share =
      asked > 0 ? static_cast<double>(outcome.completed) / static_cast<double>(asked) : 0.0;
  progress(outcome.success ? WorkProgress::SUCCEEDED : WorkProgress::FAILED, "", share, 0.0,
           outcome.message);
  if (outcome.success)
    ROS_INFO("%s", outcome.message.c_str());
  else
    ROS_ERROR("%s", outcome.message.c_str());
  running_ = false;
  return true;
}

bool PlannerNode::onStop(std_srvs::Trigger::Request&, std_srvs::Trigger::Response& response) {
  response.success = true;
  if (!running_) {
    response.message = "nothing was moving";
    return true;
  }
  stop_ = true;
  response.success = waitFor([this] { return !running_; }, params_.start_timeout);
  response.message = response.success
                         ? "the tool was brought to rest"
                         : "asked to stop, but the motion has not ended; does the clock run?";
  return true;
}

std::optional<Pose> PlannerNode::startPose() {
  const std::lock_guard<std::mutex> lock(mutex_);
  // A correction stands between what was desired and the set-point, so the pose desired last is
  // the better start, unless somebody else has moved the robot since.
  const bool moved = setpoint_ && setpoint_at_end_ &&
                     ((setpoint_->p - setpoint_at_end_->p).norm() > kSamePosition ||
                      rotationAngle(setpoint_->q, setpoint_at_end_->q) > kSameAngle);
  if (last_desired_ && !moved) return last_desired_->pose;
  return setpoint_;
}

namespace {

/// @throws InvalidInput  a target that is no pose, outside the box, or out of the robot's reach
std::vector<Pose> targetsOf(const RunPlanner::Request& request, const DebridementConfig& config,
                            const DebridementMotion& motion) {
  std::vector<Pose> targets;
  for (std::size_t i = 0; i < request.targets.size(); ++i) {
    Pose target = poseFromMsg(request.targets[i]);
    if (!isFinite(target) || !hasUnitQuaternion(target))
      throw InvalidInput(
          format("target %zu is not a finite pose with a unit quaternion (x, y, z, w)", i));
    target.q.normalize();
    if (!(target.p.array() >= config.box_lower.array()).all() ||
        !(target.p.array() <= config.box_upper.array()).all())
      throw InvalidInput(
          format("target %zu at (%g, %g, %g) m is outside the box of the planner "
                 "(box_lower, box_upper); are positions in metres?",
                 i, target.p.x(), target.p.y(), target.p.z()));
    if (!motion.isReachable(target))
      throw InvalidInput(format("target %zu at (%g, %g, %g) m is out of the robot's reach", i,
                                target.p.x(), target.p.y(), target.p.z()));
    targets.push_back(target);
  }
  if (!targets.empty() && request.trajectories != 0 && request.trajectories != targets.size())
    throw InvalidInput(format("trajectories = %u, but there are %zu targets; leave it 0",
                              request.trajectories, targets.size()));
  return targets;
}

}  // namespace

DebridementTrajectory PlannerNode::nextMotion(const std::vector<Pose>& targets, unsigned i,
                                              DebridementMotion& motion) const {
  if (!targets.empty()) return motion.moveTo(targets[i], 0.0);
  return params_.debridement ? motion.next(0.0) : motion.moveTo(motion.randomTarget(), 0.0);
}

PlannerNode::Outcome PlannerNode::runMotions(const RunPlanner::Request& request) {
  Outcome outcome;
  DebridementConfig config = params_.motion;
  if (request.trajectories == 0 && request.targets.empty())
    throw InvalidInput("trajectories = 0, must be > 0; 50 are enough to train a model");
  if (!(request.speed >= 0.0 && request.speed <= 1.0))
    throw InvalidInput(
        format("speed = %g m/s is outside [0, 1]; 0 takes the planner's own", request.speed));
  if (request.speed > 0.0) config.speed = request.speed;
  if (!(request.turn >= 0.0 && request.turn <= 1.0))
    throw InvalidInput(
        format("turn = %g rad is outside [0, 1]; 0 takes the planner's own", request.turn));
  if (request.turn > 0.0) config.orientation_deviation.setConstant(request.turn);
  if (!(request.margin >= 0.0 && request.margin <= 0.05))
    throw InvalidInput(format("margin = %g m is outside [0, 0.05]; 0 takes the field as configured",
                              request.margin));
  config.field_size.array() += 2.0 * request.margin;
  config.box_lower.array() -= request.margin;
  config.box_upper.array() += request.margin;
  const std::string prefix = request.prefix.empty() ? "t" : request.prefix;
  DebridementMotion motion(config, robot_, request.seed);
  const std::vector<Pose> targets = targetsOf(request, config, motion);
  const unsigned count =
      targets.empty() ? request.trajectories : static_cast<unsigned>(targets.size());

  if (!waitFor([] { return ros::Time::now().isValid(); }, params_.start_timeout))
    throw InvalidInput("the clock stands at 0: /use_sim_time is set, but nobody publishes /clock");
  if (!waitFor([this] { return desired_.getNumSubscribers() > 0; }, params_.start_timeout))
    throw InvalidInput("nobody listens to " + desired_.getTopic() +
                       "; start the corrector, or remap desired/servo_cp to servo_cp");
  if (!waitFor([this] { return startPose().has_value(); }, params_.start_timeout))
    throw InvalidInput("no message on " + setpoint_subscriber_.getTopic() +
                       ", so the start is unknown; does the robot's controller run?");

  const auto stopped = [&] {
    outcome.message = format("stopped after %u of %u motions", outcome.completed, count);
    return outcome;
  };
  const double begin = now();
  const ros::SteadyTime real_begin = ros::SteadyTime::now();  // people wait in real time
  double last_stamp = 0.0;
  progress(WorkProgress::RUNNING, "moving to the start", 0.0, -1.0, "");
  const PoseStream approach =
      smoothMove(*startPose(), motion.rest(), config.speed, config.angular_speed,
                 config.acceleration, 1.0 / config.rate);
  if (!play(approach, {}, now(), last_stamp) || !rest()) return stopped();

  const unsigned report_every = std::max(1u, (count + kReports - 1) / kReports);
  for (unsigned i = 0; i < count; ++i) {
    const DebridementTrajectory trajectory = nextMotion(targets, i, motion);
    const std::string name = prefix + format("%03u", i);
    const double start = now();
    announce(name, trajectory, start);
    last_stamp = start;  // it may be stopped before its first command
    const bool completed = play(trajectory.commands, trajectory.jaw, start, last_stamp);
    endOf(name, trajectory, last_stamp, completed);
    if (completed) ++outcome.completed;
    const double share = static_cast<double>(outcome.completed) / count;
    const double elapsed = (ros::SteadyTime::now() - real_begin).toSec();
    const double left = share > 0.0 ? elapsed * (1.0 - share) / share : -1.0;
    const std::string text = format("%u of %u motions", outcome.completed, count);
    progress(WorkProgress::RUNNING, "moving", share, left, text);
    if (outcome.completed % report_every == 0 && outcome.completed < count)
      ROS_INFO("%s, %.0f s left", text.c_str(), left);
    if (!completed || (!rest() && i + 1 < count)) return stopped();
  }
  outcome.success = true;
  outcome.message = format("%u motions in %.1f s", outcome.completed, now() - begin);
  return outcome;
}

/// @param jaw  opening with each pose of `motion`, or empty; left as it is during a stop [rad]
/// @return false when it was stopped before its end
bool PlannerNode::play(const PoseStream& motion, const std::vector<double>& jaw, double start,
                       double& last_stamp) {
  Playback playback(motion, start, 1.0 / params_.motion.rate);
  std::size_t sent = 0;  // of the openings
  while (!playback.finished()) {
    if (!ros::ok()) return false;
    if (stop_) playback.stop(params_.stop_time);
    if (const std::optional<StampedPose> command = playback.next(now())) {
      desired_.publish(stampedPoseToMsg(command->stamp, command->pose, params_.base_frame));
      if (!playback.stopping() && sent < jaw.size()) ++sent;
      if (sent > 0)
        jaw_.publish(
            jointsToMsg(command->stamp, {"jaw"}, Eigen::VectorXd::Constant(1, jaw[sent - 1])));
      last_desired_ = command;
      last_stamp = command->stamp;
    } else {
      sleepUntil(playback.due());
    }
  }
  return !playback.stopping();
}

/// Silence, in which the tool comes to rest. @return false when it was stopped meanwhile
bool PlannerNode::rest() {
  const double end = now() + params_.silence;
  while (ros::ok() && !stop_ && now() < end) sleepUntil(end);
  const std::lock_guard<std::mutex> lock(mutex_);
  setpoint_at_end_ = setpoint_;
  return ros::ok() && !stop_;
}

void PlannerNode::announce(const std::string& name, const DebridementTrajectory& trajectory,
                           double start) {
  geometry_msgs::PoseArray path;
  path.header.stamp.fromSec(start);
  path.header.frame_id = params_.base_frame;
  for (const StampedPose& command : trajectory.commands)
    path.poses.push_back(poseToMsg(command.pose));
  path_.publish(path);
  TrajectoryEvent event;
  event.header.stamp = path.header.stamp;
  event.trajectory = name;
  event.kind = toString(trajectory.kind);
  event.event = TrajectoryEvent::START;
  event.target = poseToMsg(trajectory.target);
  event_.publish(event);
}

void PlannerNode::endOf(const std::string& name, const DebridementTrajectory& trajectory,
                        double stamp, bool completed) {
  TrajectoryEvent event;
  event.header.stamp.fromSec(stamp);
  event.trajectory = name;
  event.kind = toString(trajectory.kind);
  event.event = TrajectoryEvent::END;
  if (completed) event.target = poseToMsg(trajectory.target);  // else all zero: it was not reached
  event_.publish(event);
}

void PlannerNode::progress(std::uint8_t state, const std::string& phase, double fraction,
                           double time_left, const std::string& message) {
  WorkProgress msg;
  msg.header.stamp = ros::Time::now();
  msg.state = state;
  msg.phase = phase;
  msg.fraction = fraction;
  msg.time_left = time_left;
  msg.message = message;
  progress_.publish(msg);
}

}  // namespace raven_correction
