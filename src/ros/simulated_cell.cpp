// SPDX-License-Identifier: BSD-3-Clause
#include "raven_correction/ros/simulated_cell.h"

#include <algorithm>
#include <limits>

#include "raven_correction/error.h"
#include "raven_correction/simulation/instrument_clearance.h"

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
  jaw_open_ = false;
  restartReports(start);
}

void SimulatedCell::restart(double start) {
  // Stamps move with the clock; where motors and joints are, what plays and lags remember, and how
  // old the session is, stay.
  ArmState state = arm_.state();
  state.start += start - state.time;
  state.time = start;
  state.active = {start, state.setpoint};
  state.pending.clear();
  state.command_joints = state.setpoint;
  state.pending_jaw.clear();
  state.last_stamp = state.last_jaw_stamp = -std::numeric_limits<double>::infinity();
  arm_.restore(state);
  restartReports(start);
}

double SimulatedCell::nextReport() const noexcept {
  return std::min({next_measured_, next_setpoint_, next_joints_, motion_capture_.nextExposure()});
}

/// The arm is at `time`.
void SimulatedCell::reportAt(double time, const std::vector<Obstacle>& obstacles) {
  noticeJaw(time);
  for (const Obstacle& other : obstacles)
    report_.clearance =
        std::min(report_.clearance,
                 clearance(instrumentOf(arm_.config().motion_capture.rig, arm_.toolPose()), other));
  if (next_measured_ <= time) {
    report_.measured.push_back({time, arm_.measuredPose()});
    next_measured_ += 1.0 / rates_.measured_cp;
  }
  if (next_setpoint_ <= time) {
    report_.setpoint.push_back({time, arm_.setpointPose()});
    next_setpoint_ += 1.0 / rates_.setpoint_cp;
  }
  if (next_joints_ <= time) {
    report_.joints.push_back({time, arm_.encoderJoints()});
    report_.jaw.push_back({time, Eigen::VectorXd::Constant(1, arm_.jaw())});
    next_joints_ += 1.0 / rates_.measured_js;
  }
  if (motion_capture_.nextExposure() <= time) {
    const MocapFrame frame = motion_capture_.capture(arm_.toolPose(), obstacles);
    if (frame.pose) in_flight_.push_back(*frame.pose);
  }
}

void SimulatedCell::noticeJaw(double time) {
  const double opening = arm_.jaw();
  const bool open = opening >= arm_.config().gripper.grasp_opening;
  if (open != jaw_open_)
    report_.passages.push_back({time, !open, open ? opening : widest_, arm_.toolPose()});
  widest_ = open && jaw_open_ ? std::max(widest_, opening) : opening;
  jaw_open_ = open;
}

void SimulatedCell::endReports(double time) {
  while (!in_flight_.empty() && in_flight_.front().stamp <= time) {
    report_.mocap.push_back(in_flight_.front());
    in_flight_.pop_front();
  }
}

const CellReport& SimulatedCell::advanceTo(double time) {
  advanceTogether({this}, time);
  return report_;
}

void advanceTogether(const std::vector<SimulatedCell*>& cells, double time) {
  for (SimulatedCell* const cell : cells) {
    cell->report_.measured.clear();
    cell->report_.setpoint.clear();
    cell->report_.joints.clear();
    cell->report_.jaw.clear();
    cell->report_.mocap.clear();
    cell->report_.passages.clear();
    cell->report_.clearance = std::numeric_limits<double>::infinity();
  }
  std::vector<Obstacle> obstacles;
  for (;;) {
    double next = std::numeric_limits<double>::infinity();
    for (const SimulatedCell* const cell : cells) next = std::min(next, cell->nextReport());
    if (!(next <= time)) break;
    for (SimulatedCell* const cell : cells) cell->arm_.advanceTo(next);
    for (SimulatedCell* const cell : cells) {
      if (cell->nextReport() > next) continue;
      obstacles.clear();
      const std::string& frame = cell->arm_.config().robot.frame();
      for (const SimulatedCell* const other : cells)
        if (other != cell && other->arm_.config().robot.frame() == frame)
          obstacles.push_back(
              instrumentOf(other->arm_.config().motion_capture.rig, other->arm_.toolPose()));
      cell->reportAt(next, obstacles);
    }
  }
  for (SimulatedCell* const cell : cells) {
    cell->arm_.advanceTo(time);
    cell->endReports(time);
  }
}

}  // namespace raven_correction
