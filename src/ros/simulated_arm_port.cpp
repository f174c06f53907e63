// SPDX-License-Identifier: BSD-3-Clause
#include "raven_correction/ros/simulated_arm_port.h"

#include <cmath>

#include "raven_correction/JawEvent.h"
#include "raven_correction/error.h"
#include "raven_correction/ros/conversions.h"
#include "raven_correction/ros/jaw_event.h"
#include "raven_correction/ros/topics.h"

namespace raven_correction {
namespace {

void publishJoints(const ros::Publisher& publisher, const std::vector<std::string>& names,
                   const std::vector<StampedJoints>& samples) {
  for (const StampedJoints& sample : samples)
    publisher.publish(jointsToMsg(sample.stamp, names, sample.positions));
}

}  // namespace

SimulatedArmPort::SimulatedArmPort(const ros::NodeHandle& nh, const std::string& node,
                                   const SimulatedArmParams& params)
    : params_(params),
      gate_(params.gate),
      jaw_arrival_(params.gate.stamp_tolerance),
      X_mocap_base_(params.X_base_mocap.inverse()),
      nh_(nh) {
  use(loadSimulationConfig(params.simulation));
  measured_ = nh_.advertise<geometry_msgs::PoseStamped>(topics::kEncoder, 10);
  setpoint_ = nh_.advertise<geometry_msgs::PoseStamped>(topics::kSetpoint, 10);
  joints_ = nh_.advertise<sensor_msgs::JointState>(topics::kJoints, 10);
  jaw_ = nh_.advertise<sensor_msgs::JointState>(topics::kJaw, 10);
  mocap_ = nh_.advertise<geometry_msgs::PoseStamped>(topics::kMocap, 100);
  jaw_event_ = nh_.advertise<JawEvent>(kJawEventTopic, 10);
  reset_ = nh_.advertiseService(node + "/reset", &SimulatedArmPort::onReset, this);
  load_ = nh_.advertiseService(node + "/load", &SimulatedArmPort::onLoad, this);
  const ros::TransportHints hints = ros::TransportHints().tcpNoDelay();
  command_ = nh_.subscribe(topics::kCommand, 1, &SimulatedArmPort::onCommand, this, hints);
  jaw_command_ = nh_.subscribe(topics::kJawCommand, 1, &SimulatedArmPort::onJaw, this, hints);
  ROS_INFO("simulating %s as %s: commands from %s and %s, motion capture on %s",
           config_.name.c_str(), config_.robot.name().c_str(), command_.getTopic().c_str(),
           jaw_command_.getTopic().c_str(), mocap_.getTopic().c_str());
}

void SimulatedArmPort::use(const SimulationConfig& config) {
  if (config.robot.frame() != params_.base_frame)
    throw InvalidInput(format(
        "simulation %s: its robot %s is described in frame \"%s\", but base_frame is \"%s\": its "
        "poses would be published in a frame that they are not in; set base_frame to the robot's",
        config.name.c_str(), config.robot.name().c_str(), config.robot.frame().c_str(),
        params_.base_frame.c_str()));
  if (cell_)
    cell_ = std::make_unique<SimulatedCell>(
        config, params_.rates, static_cast<std::uint64_t>(params_.seed), cell_->time());
  config_ = config;
  joint_names_ = config.robot.jointNames();
}

void SimulatedArmPort::start(double time) {
  cell_ = std::make_unique<SimulatedCell>(config_, params_.rates,
                                          static_cast<std::uint64_t>(params_.seed), time);
}

void SimulatedArmPort::publish() {
  const CellReport& report = cell_->report();
  for (const StampedPose& sample : report.measured)
    measured_.publish(stampedPoseToMsg(sample.stamp, sample.pose, params_.base_frame));
  for (const StampedPose& sample : report.setpoint)
    setpoint_.publish(stampedPoseToMsg(sample.stamp, sample.pose, params_.base_frame));
  for (const StampedPose& sample : report.mocap)
    mocap_.publish(
        stampedPoseToMsg(sample.stamp, X_mocap_base_ * sample.pose, params_.mocap_frame));
  for (const JawPassage& passage : report.passages) {
    JawEvent msg;
    msg.header.stamp.fromSec(passage.stamp);
    msg.header.frame_id = params_.base_frame;
    msg.event = passage.closed ? JawEvent::CLOSED : JawEvent::OPENED;
    msg.opening = passage.opening;
    msg.pose = poseToMsg(passage.X_base_tool);
    jaw_event_.publish(msg);
  }
  publishJoints(joints_, joint_names_, report.joints);
  publishJoints(jaw_, {"jaw"}, report.jaw);
}

geometry_msgs::TransformStamped SimulatedArmPort::registration() const {
  geometry_msgs::TransformStamped msg;
  msg.header.stamp.fromSec(cell_->time());
  msg.header.frame_id = params_.base_frame;
  msg.child_frame_id = params_.mocap_frame;
  msg.transform = transformToMsg(params_.X_base_mocap);
  return msg;
}

// The controller knows the time of its last cycle; what arrives acts from there on.
void SimulatedArmPort::onCommand(const ros::MessageEvent<geometry_msgs::PoseStamped const>& event) {
  if (!cell_) return;
  const geometry_msgs::PoseStamped& msg = *event.getConstMessage();
  ArrivedCommand command;
  command.pose = stampedPoseFromMsg(msg);
  command.frame = msg.header.frame_id;
  command.publisher = event.getPublisherName();
  command.replay = replays_.isReplay(event.getConnectionHeaderPtr());

  const CommandVerdict verdict = gate_.judge(cell_->time(), cell_->arm().measuredPose().p, command);
  if (!isTaken(verdict)) {
    gate_.count(verdict);
    if (verdict == CommandVerdict::kFirstDiscarded) {
      ROS_INFO("%s: the first command has woken the controller, and is not executed",
               command_.getTopic().c_str());
      return;
    }
    ROS_WARN_THROTTLE(5.0, "%s: command from %s is not taken: %s (frame \"%s\", expected \"%s\")",
                      command_.getTopic().c_str(), command.publisher.c_str(), toString(verdict),
                      command.frame.c_str(), params_.base_frame.c_str());
    return;
  }
  const IkStatus status = cell_->command(command.pose);
  gate_.count(reproducesPose(status) ? verdict : CommandVerdict::kNoIk);
  if (reproducesPose(status)) return;
  const Eigen::Vector3d& p = command.pose.pose.p;
  ROS_WARN_THROTTLE(5.0, "%s: command at (%.4f, %.4f, %.4f) m in %s is not taken: %s",
                    command_.getTopic().c_str(), p.x(), p.y(), p.z(), params_.base_frame.c_str(),
                    toString(status));
}

void SimulatedArmPort::onJaw(const ros::MessageEvent<sensor_msgs::JointState const>& event) {
  if (!cell_) return;
  const sensor_msgs::JointState& msg = *event.getConstMessage();
  const double stamp = msg.header.stamp.toSec();
  const char* problem = nullptr;
  if (replays_.isReplay(event.getConnectionHeaderPtr()))
    problem = "the replay of a latched publisher";
  else if (msg.position.size() != 1 || !std::isfinite(msg.position[0]))
    problem = "`position` must hold one finite opening [rad]";
  else if (!cell_->commandJaw(jaw_arrival_.actingTime(cell_->time(), stamp), msg.position[0]))
    problem = "too many commands wait";
  ++(problem == nullptr ? jaw_taken_ : jaw_refused_);
  if (problem != nullptr)
    ROS_WARN_THROTTLE(5.0, "%s: jaw command from %s is not taken: %s",
                      jaw_command_.getTopic().c_str(), event.getPublisherName().c_str(), problem);
}

bool SimulatedArmPort::onReset(std_srvs::Trigger::Request&, std_srvs::Trigger::Response& response) {
  response.success = cell_ != nullptr;
  if (!cell_) {
    response.message = "the clock has not started; is somebody publishing /clock?";
    return true;
  }
  cell_->reset(cell_->time());
  gate_.reset();
  jaw_arrival_.reset();
  response.message = "the arm rests at its homing position";
  ROS_INFO("%s: %s", reset_.getService().c_str(), response.message.c_str());
  return true;
}

bool SimulatedArmPort::onLoad(LoadModel::Request& request, LoadModel::Response& response) {
  try {
    use(loadSimulationConfig(request.file));
    gate_.reset();
    jaw_arrival_.reset();
    response.success = true;
    response.message = "simulating " + config_.name + "; the arm rests at its homing position";
    ROS_INFO("%s: %s", load_.getService().c_str(), response.message.c_str());
  } catch (const InvalidInput& error) {
    response.success = false;
    response.message = std::string(error.what()) + "; still simulating " + config_.name;
    ROS_ERROR("%s: %s", load_.getService().c_str(), response.message.c_str());
  }
  response.model = config_.name;
  return true;
}

void SimulatedArmPort::diagnose(diagnostic_updater::DiagnosticStatusWrapper& status) const {
  using diagnostic_msgs::DiagnosticStatus;
  const std::uint64_t no_ik = gate_.counted(CommandVerdict::kNoIk);
  if (!cell_)
    status.summary(DiagnosticStatus::WARN, "the clock has not started");
  else if (no_ik > 0)
    status.summaryf(DiagnosticStatus::WARN, "%lu commands were out of reach",
                    static_cast<unsigned long>(no_ik));
  else
    status.summary(DiagnosticStatus::OK, "simulating " + config_.name);
  status.add("simulation", config_.name);
  status.add("seed", params_.seed);
  for (int i = 0; i < kCommandVerdicts; ++i) {
    const auto verdict = static_cast<CommandVerdict>(i);
    status.add(std::string("commands ") + toString(verdict), gate_.counted(verdict));
  }
  status.add("jaw commands taken", jaw_taken_);
  status.add("jaw commands refused", jaw_refused_);
  if (!cell_) return;
  const SimulatedArm& arm = cell_->arm();
  status.add("commands stopped at a joint limit",
             arm.commandCounts()[static_cast<std::size_t>(IkStatus::kOutsideLimits)]);
  status.addf("jaw opening [rad]", "%.3f", arm.jaw());
  status.addf("payload [g]", "%.3f", 1e3 * arm.payload());
}

}  // namespace raven_correction
