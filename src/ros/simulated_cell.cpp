// SPDX-License-Identifier: BSD-3-Clause
#include "raven_correction/ros/simulated_cell.h"

#include <algorithm>

#include "raven_correction/error.h"

namespace raven_correction {
namespace {

void requireRate(const char* name, double rate) {
  if (!(rate > 0.0 && rate <= 1000.0))
    throw InvalidInput(format("rate of %s = %g Hz is outside (0, 1000]", name, rate));
}

}  // namespace

SimulatedCell::SimulatedCell(const SimulationConfig& config, const ReportRates& rates,
                             std::uint64_t seed, double start)
    : rates_(rates), arm_(config, start), motion_capture_(config.motion_capture, seed, start) {
  requireRate("measured_cp", rates.measured_cp);
  requireRate("setpoint_cp", rates.setpoint_cp);
  requireRate("measured_js", rates.measured_js);
  restartReports(start);
}

void SimulatedCell::restartReports(double start) {
  next_measured_ = start;
  next_setpoint_ = start;
  next_joints_ = start;
  motion_capture_.restart(start);
  in_flight_.clear();
}

void SimulatedCell::reset(double start) {
  arm_.reset(start);
  restartReports(start);
}

void SimulatedCell::restart(double start) {
  const JointVector joints = arm_.setpointJoints();
  arm_.reset(start, joints);
  restartReports(start);
}

void SimulatedCell::reportAt(double time) {
  arm_.advanceTo(time);
  if (next_measured_ <= time) {
    report_.measured.push_back({time, arm_.measuredPose()});
    next_measured_ += 1.0 / rates_.measured_cp;
  }
  if (next_setpoint_ <= time) {
    report_.setpoint.push_back({time, arm_.setpointPose()});
    next_setpoint_ += 1.0 / rates_.setpoint_cp;
  }
  if (next_joints_ <= time) {
    report_.joints.push_back({time, arm_.motorJoints()});
    next_joints_ += 1.0 / rates_.measured_js;
  }
  if (motion_capture_.nextExposure() <= time) {
    const MocapFrame frame = motion_capture_.capture(arm_.toolPose());
    if (frame.pose) in_flight_.push_back(*frame.pose);
  }
}

const CellReport& SimulatedCell::advanceTo(double time) {
  report_.measured.clear();
  report_.setpoint.clear();
  report_.joints.clear();
  report_.mocap.clear();
  for (;;) {
    const double next =
        std::min({next_measured_, next_setpoint_, next_joints_, motion_capture_.nextExposure()});
    if (!(next <= time)) break;
    reportAt(next);
  }
  arm_.advanceTo(time);
  while (!in_flight_.empty() && in_flight_.front().stamp <= time) {
    report_.mocap.push_back(in_flight_.front());
    in_flight_.pop_front();
  }
  return report_;
}

}  // namespace raven_correction
