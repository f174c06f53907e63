// SPDX-License-Identifier: BSD-3-Clause
#include "raven_correction/evaluation/test_states.h"

#include <limits>

#include "raven_correction/dataset/synchronisation.h"

namespace raven_correction {
namespace {

void appendTrajectory(const Trajectory& trajectory, std::size_t index, const MotionOptions& motion,
                      double delay, double max_gap, const CleanGates& gates,
                      MotionEstimator& estimator, std::vector<TestState>& states) {
  const PoseStream commands = screenCommands(trajectory.commands).samples;
  const ScreenedStream screened = screenObservations(trajectory.observations);
  std::vector<Motion> central;
  if (motion.velocity == VelocityKind::kCentral) central = motionsOf(screened.samples, motion);
  MotionOptions causal;
  causal.velocity = VelocityKind::kCausal;
  causal.max_gap = motion.max_gap;
  MotionEstimator speed(causal);
  estimator.startMotion();
  using Outcome = MotionEstimator::Outcome;
  for (std::size_t row = 0; row < trajectory.observations.size(); ++row) {
    const StampedPose& observation = trajectory.observations[row];
    const Outcome outcome = estimator.push(observation.stamp, observation.pose);
    speed.push(observation.stamp, observation.pose);
    if (outcome != Outcome::kAccepted && outcome != Outcome::kRepeated) continue;
    const double instant = observation.stamp - delay;
    const auto command = poseAt(commands, instant, std::numeric_limits<double>::infinity());
    if (!command) continue;
    TestState state;
    state.trajectory = index;
    state.row = row;
    state.motion = estimator.motion();
    if (!central.empty()) state.motion.twists = central[screened.index_of[row]].twists;
    state.command = *command;
    const Motion& moving = speed.motion();
    state.plausible = outcome == Outcome::kAccepted && screened.fate[row] == Fate::kKept &&
                      poseAt(commands, instant, max_gap).has_value() &&
                      moving.step <= gates.max_step &&
                      moving.twists[0].v.norm() <= gates.max_speed &&
                      moving.twists[0].w.norm() <= gates.max_angular_speed;
    states.push_back(state);
  }
}

}  // namespace

std::vector<TestState> makeTestStates(const Dataset& dataset, const MotionOptions& motion,
                                      double delay, double max_gap, const CleanGates& gates) {
  std::vector<TestState> states;
  MotionEstimator estimator(motion);
  for (std::size_t k = 0; k < dataset.trajectories.size(); ++k)
    appendTrajectory(dataset.trajectories[k], k, motion, delay, max_gap, gates, estimator, states);
  return states;
}

std::vector<bool> cleanStates(const std::vector<TestState>& states, const Pose& rigid,
                              const CleanGates& gates) {
  std::vector<bool> chosen(states.size());
  for (std::size_t i = 0; i < states.size(); ++i) {
    const PoseError residual = poseError(rigid * states[i].motion.pose, states[i].command);
    chosen[i] = states[i].plausible &&
                residual.components.head<3>().norm() <= gates.max_position_residual &&
                residual.angle <= gates.max_angle_residual;
  }
  return chosen;
}

std::vector<PoseError> errorsOf(const std::vector<TestState>& states, PredictionKind kind,
                                const Predictor* predictor) {
  std::vector<PoseError> errors;
  errors.reserve(states.size());
  const auto workspace = kind == PredictionKind::kFull ? predictor->makeWorkspace() : nullptr;
  for (const TestState& state : states) {
    Pose predicted = state.motion.pose;
    if (kind == PredictionKind::kRigid) predicted = predictor->model().rigid * predicted;
    if (kind != PredictionKind::kFull) {
      errors.push_back(poseError(predicted, state.command));
      continue;
    }
    const Prediction full = predictor->predict(state.motion, *workspace);
    PoseError error = poseError(full.command, state.command);
    error.residual =
        correctionBetween(full.mean, state.command) - correctionBetween(full.mean, full.command);
    error.deviation << full.sd_position, full.sd_rotation;
    errors.push_back(error);
  }
  return errors;
}

std::vector<PoseError> pick(const std::vector<PoseError>& errors, const std::vector<bool>& chosen) {
  std::vector<PoseError> picked;
  for (std::size_t i = 0; i < errors.size(); ++i)
    if (chosen[i]) picked.push_back(errors[i]);
  return picked;
}

}  // namespace raven_correction
