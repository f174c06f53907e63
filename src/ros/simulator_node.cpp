// SPDX-License-Identifier: BSD-3-Clause
#include "raven_correction/ros/simulator_node.h"

#include <ros/callback_queue.h>
#include <rosgraph_msgs/Clock.h>
#include <sensor_msgs/JointState.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <thread>

#include "raven_correction/error.h"
#include "raven_correction/ros/conversions.h"
#include "raven_correction/ros/params.h"
#include "raven_correction/ros/topics.h"

namespace raven_correction {
namespace {

constexpr double kLongestClockStep = 0.01;  // of simulated time between two cycles [s]
constexpr double kClockJump = 1.0;          // of the followed clock: not made up for, but said [s]
constexpr double kGiveUpLateness = 0.1;     // of a cycle: the schedule starts afresh [s]

double steadySeconds() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

/// @param values  x y z [m] yaw pitch roll [rad]
Pose poseFromYawPitchRoll(const std::vector<double>& values) {
  return {{values[0], values[1], values[2]},
          Eigen::AngleAxisd(values[3], Eigen::Vector3d::UnitZ()) *
              Eigen::AngleAxisd(values[4], Eigen::Vector3d::UnitY()) *
              Eigen::AngleAxisd(values[5], Eigen::Vector3d::UnitX())};
}

}  // namespace

SimulatorParams loadSimulatorParams(const ros::NodeHandle& nh) {
  SimulatorParams params;
  // Where the debridement session of 2014 had its cameras.
  std::vector<double> registration{0.087, 1.778, -0.770, -0.273, -0.050, 1.586};
  ParamReader read(nh, "simulator");
  read.requiredText("simulation", params.simulation,
                    "set it to a file of the package's config/simulation");
  read.integer("seed", params.seed, 0, std::numeric_limits<int>::max());
  read.positive("measured_cp_rate", params.rates.measured_cp, 1000.0);
  read.positive("setpoint_cp_rate", params.rates.setpoint_cp, 1000.0);
  read.positive("measured_js_rate", params.rates.measured_js, 1000.0);
  read.text("base_frame", params.base_frame);
  read.text("mocap_frame", params.mocap_frame);
  read.numbers("mocap_registration", registration, 6, -10.0, 10.0);
  read.flag("discard_first_command", params.gate.discard_first);
  read.number("max_step", params.gate.max_step, 0.0, 1.0);
  read.number("reject_step", params.gate.reject_step, 0.0, 1.0);
  read.number("stamp_tolerance", params.gate.stamp_tolerance, 0.0, 10.0);
  read.number("loop_rate", params.loop_rate, 50.0, 2000.0);
  read.number("clock_rate", params.clock_rate, 0.0, 20.0);
  read.number("clock_frequency", params.clock_frequency, 10.0, 1000.0);
  read.refuseUnknownKeys({"diagnostic_period"});
  read.throwIfAnyProblem();
  params.gate.base_frame = params.base_frame;
  params.X_base_mocap = poseFromYawPitchRoll(registration);
  if (params.mocap_frame.empty()) throw InvalidInput("simulator: ~mocap_frame is empty");
  if (params.clock_rate > 0.0 && !ros::Time::isSimTime())
    throw InvalidInput(
        format("simulator: ~clock_rate is %g, but /use_sim_time is not true, so no node would "
               "listen to /clock; set it before any node starts, as demo.launch does",
               params.clock_rate));
  ROS_INFO_STREAM(read.summary());
  return params;
}

SimulatorNode::SimulatorNode(const ros::NodeHandle& nh, const ros::NodeHandle& private_nh,
                             const SimulatorParams& params)
    : params_(params),
      config_(loadSimulationConfig(params.simulation)),
      gate_(params.gate),
      joint_names_(config_.robot.jointNames()),
      X_mocap_base_(params.X_base_mocap.inverse()),
      nh_(nh),
      diagnostics_(nh, private_nh) {
  if (params.clock_rate > 0.0)
    clock_ = std::make_unique<SimulatorClock>(params.clock_rate, ros::WallTime::now().toSec(),
                                              kLongestClockStep);
  ros::NodeHandle private_handle(private_nh);
  measured_ = nh_.advertise<geometry_msgs::PoseStamped>(topics::kEncoder, 10);
  setpoint_ = nh_.advertise<geometry_msgs::PoseStamped>(topics::kSetpoint, 10);
  joints_ = nh_.advertise<sensor_msgs::JointState>(topics::kJoints, 10);
  mocap_ = nh_.advertise<geometry_msgs::PoseStamped>(topics::kMocap, 100);
  if (clock_) clock_publisher_ = nh_.advertise<rosgraph_msgs::Clock>("/clock", 10);
  reset_ = private_handle.advertiseService("reset", &SimulatorNode::onReset, this);
  load_ = private_handle.advertiseService("load", &SimulatorNode::onLoad, this);
  diagnostics_.setHardwareID(config_.robot.name() + " (simulated)");
  diagnostics_.add("controller", this, &SimulatorNode::report);
  command_ = nh_.subscribe(topics::kCommand, 1, &SimulatorNode::onCommand, this,
                           ros::TransportHints().tcpNoDelay());
  ROS_INFO("simulating %s as %s: commands from %s, motion capture on %s", config_.name.c_str(),
           config_.robot.name().c_str(), command_.getTopic().c_str(), mocap_.getTopic().c_str());
}

double SimulatorNode::now() {
  return clock_ ? clock_->advance(steadySeconds()) : ros::Time::now().toSec();
}

void SimulatorNode::run() {
  using Clock = std::chrono::steady_clock;
  const auto period = std::chrono::duration_cast<Clock::duration>(
      std::chrono::duration<double>(1.0 / params_.loop_rate));
  auto due = Clock::now();
  while (ros::ok()) {
    cycle(now());
    due += period;
    std::this_thread::sleep_until(due);
    const double lateness = std::chrono::duration<double>(Clock::now() - due).count();
    ++cycles_;
    if (lateness > 1.0 / params_.loop_rate) ++late_cycles_;
    worst_lateness_ = std::max(worst_lateness_, lateness);
    if (lateness > kGiveUpLateness) due = Clock::now();
  }
}

void SimulatorNode::cycle(double time) {
  if (clock_) publishClock(time, steadySeconds());
  if (time > 0.0) {  // a followed clock stands at 0 until somebody publishes it
    if (!cell_) {
      cell_ = std::make_unique<SimulatedCell>(config_, params_.rates,
                                              static_cast<std::uint64_t>(params_.seed), time);
      publishRegistration();
    }
    const double jump = time - cell_->time();
    if (jump < 0.0 || jump > kClockJump) {
      ROS_WARN("the clock jumped by %.3f s: pending commands are forgotten, the arm stays", jump);
      cell_->restart(time);
    }
    // Commands first: those that arrived since the last cycle act in the interval that ends now.
    ros::getGlobalCallbackQueue()->callAvailable(ros::WallDuration(0.0));
    publish(cell_->advanceTo(time));
  } else {
    ros::getGlobalCallbackQueue()->callAvailable(ros::WallDuration(0.0));
  }
  diagnostics_.update();
}

void SimulatorNode::publishClock(double time, double steady) {
  if (steady - last_clock_ < 1.0 / params_.clock_frequency) return;
  last_clock_ = steady;
  rosgraph_msgs::Clock msg;
  msg.clock.fromSec(time);
  clock_publisher_.publish(msg);
}

void SimulatorNode::publishRegistration() {
  geometry_msgs::TransformStamped msg;
  msg.header.stamp.fromSec(cell_->time());
  msg.header.frame_id = params_.base_frame;
  msg.child_frame_id = params_.mocap_frame;
  msg.transform = transformToMsg(params_.X_base_mocap);
  static_broadcaster_.sendTransform(msg);
}

void SimulatorNode::publish(const CellReport& report) {
  for (const StampedPose& sample : report.measured)
    measured_.publish(stampedPoseToMsg(sample.stamp, sample.pose, params_.base_frame));
  for (const StampedPose& sample : report.setpoint)
    setpoint_.publish(stampedPoseToMsg(sample.stamp, sample.pose, params_.base_frame));
  for (const StampedPose& sample : report.mocap)
    mocap_.publish(
        stampedPoseToMsg(sample.stamp, X_mocap_base_ * sample.pose, params_.mocap_frame));
  for (const StampedJoints& sample : report.joints) {
    sensor_msgs::JointState msg;
    msg.header.stamp.fromSec(sample.stamp);
    msg.name = joint_names_;
    msg.position.assign(sample.positions.data(), sample.positions.data() + sample.positions.size());
    joints_.publish(msg);
  }
}

void SimulatorNode::onCommand(const ros::MessageEvent<geometry_msgs::PoseStamped const>& event) {
  if (!cell_) return;
  const geometry_msgs::PoseStamped& msg = *event.getConstMessage();
  const auto latching = event.getConnectionHeader().find("latching");
  ArrivedCommand command;
  command.pose = stampedPoseFromMsg(msg);
  command.frame = msg.header.frame_id;
  command.publisher = event.getPublisherName();
  command.latched = latching != event.getConnectionHeader().end() && latching->second == "1";

  // The controller knows the time of this cycle only.
  const double arrival = clock_ ? clock_->time() : ros::Time::now().toSec();
  const CommandVerdict verdict = gate_.judge(arrival, cell_->arm().measuredPose().p, command);
  if (!isTaken(verdict)) {
    gate_.count(verdict);
    if (verdict == CommandVerdict::kFirstDiscarded) {
      ROS_INFO("the first command has woken the controller, and is not executed");
      return;
    }
    ROS_WARN_THROTTLE(5.0, "command from %s is not taken: %s (frame \"%s\", expected \"%s\")",
                      command.publisher.c_str(), toString(verdict), command.frame.c_str(),
                      params_.base_frame.c_str());
    return;
  }
  const IkStatus status = cell_->command(command.pose);
  gate_.count(reproducesPose(status) ? verdict : CommandVerdict::kNoIk);
  if (reproducesPose(status)) return;
  const Eigen::Vector3d& p = command.pose.pose.p;
  ROS_WARN_THROTTLE(5.0, "command at (%.4f, %.4f, %.4f) m in %s is not taken: %s", p.x(), p.y(),
                    p.z(), params_.base_frame.c_str(), toString(status));
}

bool SimulatorNode::onReset(std_srvs::Trigger::Request&, std_srvs::Trigger::Response& response) {
  response.success = cell_ != nullptr;
  if (!cell_) {
    response.message = "the clock has not started; is somebody publishing /clock?";
    return true;
  }
  cell_->reset(cell_->time());
  gate_.reset();
  response.message = "the arm rests at its homing position";
  ROS_INFO("%s", response.message.c_str());
  return true;
}

bool SimulatorNode::onLoad(LoadModel::Request& request, LoadModel::Response& response) {
  try {
    const SimulationConfig loaded = loadSimulationConfig(request.file);
    if (cell_)
      cell_ = std::make_unique<SimulatedCell>(
          loaded, params_.rates, static_cast<std::uint64_t>(params_.seed), cell_->time());
    config_ = loaded;
    joint_names_ = loaded.robot.jointNames();
    gate_.reset();
    response.success = true;
    response.message = "simulating " + loaded.name + "; the arm rests at its homing position";
    ROS_INFO("%s", response.message.c_str());
  } catch (const InvalidInput& error) {
    response.success = false;
    response.message = std::string(error.what()) + "; still simulating " + config_.name;
    ROS_ERROR("%s", response.message.c_str());
  }
  response.model = config_.name;
  return true;
}

void SimulatorNode::report(diagnostic_updater::DiagnosticStatusWrapper& status) {
  using diagnostic_msgs::DiagnosticStatus;
  const double late = cycles_ > 0 ? static_cast<double>(late_cycles_) / cycles_ : 0.0;
  const std::uint64_t no_ik = gate_.counted(CommandVerdict::kNoIk);
  if (!cell_)
    status.summary(DiagnosticStatus::WARN, "the clock has not started");
  else if (late > 0.05)
    status.summaryf(DiagnosticStatus::WARN, "%.0f %% of the cycles are late: the machine is busy",
                    100.0 * late);
  else if (no_ik > 0)
    status.summaryf(DiagnosticStatus::WARN, "%lu commands were out of reach",
                    static_cast<unsigned long>(no_ik));
  else
    status.summary(DiagnosticStatus::OK, "simulating " + config_.name);
  status.add("simulation", params_.simulation);
  status.add("cycles", cycles_);
  status.add("late cycles", late_cycles_);
  status.addf("worst lateness [ms]", "%.3f", 1e3 * worst_lateness_);
  for (int i = 0; i < kCommandVerdicts; ++i) {
    const auto verdict = static_cast<CommandVerdict>(i);
    status.add(std::string("commands ") + toString(verdict), gate_.counted(verdict));
  }
  if (cell_) {
    const auto& counts = cell_->arm().commandCounts();
    status.add("commands stopped at a joint limit",
               counts[static_cast<std::size_t>(IkStatus::kOutsideLimits)]);
  }
  worst_lateness_ = 0.0;
}

}  // namespace raven_correction
