// SPDX-License-Identifier: BSD-3-Clause
#include "raven_correction/evaluation/preflight.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "raven_correction/dataset/synchronisation.h"
#include "raven_correction/error.h"
#include "raven_correction/evaluation/test_states.h"
#include "raven_correction/geometry/statistics.h"

namespace raven_correction {
namespace {

constexpr std::size_t kMostStates = 3000;  // that are judged, evenly spread
constexpr double kDegree = 180.0 / 3.14159265358979323846;

void check(const PreflightLimits& limits) {
  const auto positive = [](double value) { return value > 0.0 && std::isfinite(value); };
  if (!positive(limits.factor) || !positive(limits.max_position) || !positive(limits.max_angle) ||
      !(limits.least_position >= 0.0) || !(limits.least_angle >= 0.0) || limits.min_poses == 0 ||
      !(limits.min_extent >= 0.0))
    throw InvalidInput(format(
        "pre-flight: factor %g, at most %g m and %g rad, at least %zu poses over %g m: all must be "
        "positive and finite",
        limits.factor, limits.max_position, limits.max_angle, limits.min_poses, limits.min_extent));
}

double limitOf(double promise, double least, double factor, double most) {
  return std::isfinite(promise) ? std::min(most, factor * std::max(least, promise)) : most;
}

struct Medians {
  double position, angle;
};
Medians mediansOf(const std::vector<PoseError>& errors) {
  std::vector<double> positions, angles;
  for (const PoseError& error : errors) {
    positions.push_back(error.components.head<3>().norm());
    angles.push_back(error.angle);
  }
  return {median(std::move(positions)), median(std::move(angles))};
}

std::string millimetresAndDegrees(double position, double angle) {
  return format("%.2f mm, %.2f deg", 1e3 * position, kDegree * angle);
}

/// States that can be judged, evenly thinned.
std::vector<TestState> plausibleStates(const Correction& model, const Dataset& moves) {
  MotionOptions motion = model.motion;  // deployed models see the past only
  if (motion.velocity == VelocityKind::kCentral) motion.velocity = VelocityKind::kCausal;
  const double max_gap = std::max(0.1, commandGapLimit(moves, {}));
  std::vector<TestState> states = makeTestStates(moves, motion, model.delay, max_gap, CleanGates());
  states.erase(std::remove_if(states.begin(), states.end(),
                              [](const TestState& state) { return !state.plausible; }),
               states.end());
  if (states.size() <= kMostStates) return states;
  std::vector<TestState> thinned;
  for (std::size_t i = 0; i < kMostStates; ++i)
    thinned.push_back(states[i * states.size() / kMostStates]);
  return thinned;
}

}  // namespace

PreflightResult judgePreflight(const Correction& model, const PoseStream& commands,
                               const PoseStream& observations, const PreflightLimits& limits) {
  check(limits);
  const Predictor predictor(model);
  Dataset moves;
  moves.frame = model.frame;
  moves.trajectories.resize(1);
  moves.trajectories[0].id = "preflight";
  moves.trajectories[0].commands = commands;
  moves.trajectories[0].observations = observations;
  const std::vector<TestState> states = plausibleStates(model, moves);

  PreflightResult result;
  result.poses = states.size();
  result.promised_position = model.held_out.position_after;
  result.promised_angle = model.held_out.angle_after;
  result.max_position =
      limitOf(result.promised_position, limits.least_position, limits.factor, limits.max_position);
  result.max_angle =
      limitOf(result.promised_angle, limits.least_angle, limits.factor, limits.max_angle);
  Eigen::AlignedBox3d box;
  for (const TestState& state : states) box.extend(state.command.p);
  result.extent = states.empty() ? 0.0 : box.diagonal().norm();
  result.status = PreflightResult::Status::kNotObserved;
  if (states.size() < limits.min_poses || result.extent < limits.min_extent) {
    result.message = format(
        "%zu poses over %.0f mm, needed are %zu over %.0f mm: let the robot make a few moves while "
        "motion capture sees the tool (%zu commands and %zu observations came)",
        states.size(), 1e3 * result.extent, limits.min_poses, 1e3 * limits.min_extent,
        commands.size(), observations.size());
    return result;
  }
  const Medians off = mediansOf(errorsOf(states, PredictionKind::kFull, &predictor));
  const Medians without = mediansOf(errorsOf(states, PredictionKind::kNone, nullptr));
  result.position = off.position;
  result.angle = off.angle;
  result.uncorrected_position = without.position;
  result.uncorrected_angle = without.angle;
  const bool near = off.position <= result.max_position && off.angle <= result.max_angle;
  const double ratio = 0.5 * (off.position / without.position + off.angle / without.angle);
  const bool better = ratio < 1.0;
  result.status =
      near && better ? PreflightResult::Status::kPassed : PreflightResult::Status::kFailed;
  result.message = format("model %s is %s off (medians of %zu poses), ", model.id.c_str(),
                          millimetresAndDegrees(off.position, off.angle).c_str(), states.size());
  result.message +=
      std::isfinite(result.promised_position)
          ? "promised " + millimetresAndDegrees(result.promised_position, result.promised_angle)
          : std::string("promises nothing");
  result.message += ", allowed " + millimetresAndDegrees(result.max_position, result.max_angle) +
                    ", without correction " +
                    millimetresAndDegrees(without.position, without.angle);
  if (!near)
    result.message +=
        ": it is not valid for this robot today; record and train again, or look for what has "
        "changed (homing, tool, registration, arm)";
  else if (!better)
    result.message += ": it is no better than no correction";
  return result;
}

}  // namespace raven_correction
