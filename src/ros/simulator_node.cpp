// SPDX-License-Identifier: BSD-3-Clause
#include "raven_correction/ros/simulator_node.h"

#include <ros/callback_queue.h>
#include <rosgraph_msgs/Clock.h>
#include <std_msgs/Float64.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <thread>

namespace raven_correction {
namespace {

constexpr double kLongestClockStep = 0.01;  // of simulated time between two cycles [s]
constexpr double kClockJump = 1.0;          // of the followed clock: not made up for, but said [s]
constexpr double kClearancePeriod = 0.05;   // of its messages [s, real]
constexpr double kGiveUpLateness = 0.1;     // of a cycle: more is not made up for [s]

double steadySeconds() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

/// The node's own name without its namespace.
std::string shortName() {
  const std::string& name = ros::this_node::getName();
  return name.substr(name.rfind('/') + 1);
}

}  // namespace

SimulatorNode::SimulatorNode(const ros::NodeHandle& nh, const ros::NodeHandle& private_nh,
                             const SimulatorParams& params)
    : params_(params), nh_(nh), diagnostics_(nh, private_nh) {
  if (params.clock_rate > 0.0)
    clock_ = std::make_unique<SimulatorClock>(params.clock_rate, ros::WallTime::now().toSec(),
                                              kLongestClockStep);
  diagnostics_.add("controller", this, &SimulatorNode::report);
  std::string robots;
  for (const SimulatedArmParams& arm : params.arms) {
    arms_.push_back(
        std::make_unique<SimulatedArmPort>(ros::NodeHandle(nh, arm.name), shortName(), arm));
    const SimulatedArmPort* const port = arms_.back().get();
    diagnostics_.add(arm.name.empty() ? "arm" : arm.name,
                     [port](diagnostic_updater::DiagnosticStatusWrapper& s) { port->diagnose(s); });
    robots += (robots.empty() ? "" : ", ") + port->simulation().robot.name();
  }
  diagnostics_.setHardwareID(robots + " (simulated)");
  ros::NodeHandle own(private_nh);
  if (params.arms.size() > 1)
    clearance_publisher_ = own.advertise<std_msgs::Float64>("clearance", 10);
  pause_ = own.advertiseService("pause", &SimulatorNode::onPause, this);
  if (clock_) clock_publisher_ = nh_.advertise<rosgraph_msgs::Clock>("/clock", 10);
}

double SimulatorNode::now() {
  if (!clock_) return ros::Time::now().toSec();
  return paused_ ? clock_->hold(steadySeconds()) : clock_->advance(steadySeconds());
}

bool SimulatorNode::onPause(std_srvs::SetBool::Request& request,
                            std_srvs::SetBool::Response& response) {
  response.success = clock_ != nullptr;
  if (!clock_) {
    response.message = "the clock is not this node's: ~clock_rate is 0";
    return true;
  }
  paused_ = request.data != 0;
  response.message = paused_ ? "the clock stands" : "the clock runs";
  return true;
}

void SimulatorNode::watchClearance(double steady) {
  for (const auto& arm : arms_) clearance_ = std::min(clearance_, arm->cell()->report().clearance);
  least_clearance_ = std::min(least_clearance_, clearance_);
  if (steady - last_clearance_ < kClearancePeriod || !std::isfinite(clearance_)) return;
  last_clearance_ = steady;
  std_msgs::Float64 msg;
  msg.data = clearance_;
  clearance_publisher_.publish(msg);
  clearance_ = std::numeric_limits<double>::infinity();
}

void SimulatorNode::run() {
  using Clock = std::chrono::steady_clock;
  const auto duration = [](double seconds) {
    return std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(seconds));
  };
  const auto period = duration(1.0 / params_.loop_rate);
  // A late cycle is made up for by others that follow at once, but not for time that a clock of our
  // own has lost for good.
  const double give_up = clock_ ? kLongestClockStep / params_.clock_rate : kGiveUpLateness;
  auto due = Clock::now();
  while (ros::ok()) {
    cycle(now());
    due += period;
    std::this_thread::sleep_until(due);
    const double lateness = std::chrono::duration<double>(Clock::now() - due).count();
    ++cycles_;
    if (lateness > 1.0 / params_.loop_rate) ++late_cycles_;
    worst_lateness_ = std::max(worst_lateness_, lateness);
    if (lateness > give_up) due += duration(lateness - give_up);
  }
}

/// Starts the arms with the clock, and says when it has jumped. A followed clock stands at 0 until
/// somebody publishes it.
void SimulatorNode::follow(double time) {
  const double jump = time - time_;
  if (time_ == 0.0) {
    for (const auto& arm : arms_) arm->start(time);
    publishRegistrations();
    reported_time_ = time;
    reported_cycles_ = cycles_;
  } else if (jump < 0.0 || jump > kClockJump) {
    ROS_WARN("the clock jumped by %.3f s: pending commands are forgotten, the arms stay", jump);
    for (const auto& arm : arms_) arm->restart(time);
  }
  time_ = time;
}

void SimulatorNode::cycle(double time) {
  if (clock_) publishClock(time, steadySeconds());
  if (time > 0.0) follow(time);
  // Commands first: those that arrived since the last cycle act in the interval that ends now.
  ros::getGlobalCallbackQueue()->callAvailable(ros::WallDuration(0.0));
  if (time_ > 0.0) {
    std::vector<SimulatedCell*> cells;
    for (const auto& arm : arms_) cells.push_back(arm->cell());
    advanceTogether(cells, time_);
    for (const auto& arm : arms_) arm->publish();
    if (clearance_publisher_) watchClearance(steadySeconds());
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

void SimulatorNode::publishRegistrations() {
  std::vector<geometry_msgs::TransformStamped> registrations;
  for (const auto& arm : arms_) registrations.push_back(arm->registration());
  static_broadcaster_.sendTransform(registrations);
}

void SimulatorNode::report(diagnostic_updater::DiagnosticStatusWrapper& status) {
  using diagnostic_msgs::DiagnosticStatus;
  const double late = cycles_ > 0 ? static_cast<double>(late_cycles_) / cycles_ : 0.0;
  if (time_ == 0.0)
    status.summary(DiagnosticStatus::WARN, "the clock has not started");
  else if (late > 0.05)
    status.summaryf(DiagnosticStatus::WARN, "%.0f %% of the cycles are late: the machine is busy",
                    100.0 * late);
  else
    status.summaryf(DiagnosticStatus::OK, "%zu arms", arms_.size());
  status.add("cycles", cycles_);
  status.add("late cycles", late_cycles_);
  status.addf("worst lateness [ms]", "%.3f", 1e3 * worst_lateness_);
  status.addf("time [s]", "%.6f", time_);
  if (std::isfinite(least_clearance_))
    status.addf("smallest distance of instruments [mm]", "%.2f", 1e3 * least_clearance_);
  if (time_ > reported_time_)
    status.addf("cycles per second of the clock", "%.1f",
                static_cast<double>(cycles_ - reported_cycles_) / (time_ - reported_time_));
  worst_lateness_ = 0.0;
  reported_cycles_ = cycles_;
  reported_time_ = time_;
}

}  // namespace raven_correction
