// SPDX-License-Identifier: BSD-3-Clause
#include "raven_correction/evaluation/validated_training.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "raven_correction/error.h"

namespace raven_correction {

bool isHeldOut(const Trajectory& trajectory) noexcept {
  // Mixes the microseconds of the start stamp (splitmix64), so that regular starts do not align
  // with the choice. Source: Steele et al. 2014, doi:10.1145/2660193.2660195
  auto x = static_cast<std::uint64_t>(std::llround(trajectory.start() * 1e6));
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9ULL;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebULL;
  return (x ^ (x >> 31)) % 5 == 0;
}

ValidationSplit splitForValidation(const Dataset& dataset) {
  ValidationSplit split{dataset, dataset};
  const auto fill = [&](auto&& tests) {
    split.training.trajectories.clear();
    split.held_out.trajectories.clear();
    for (std::size_t i = 0; i < dataset.trajectories.size(); ++i)
      (tests(i) ? split.held_out : split.training).trajectories.push_back(dataset.trajectories[i]);
  };
  fill([&](std::size_t i) { return isHeldOut(dataset.trajectories[i]); });
  if (split.held_out.trajectories.empty() || split.training.trajectories.size() < 2)
    fill([](std::size_t i) { return i % 5 == 0; });
  return split;
}

namespace {

constexpr std::size_t kFewTrajectories = 5;  // to judge a model by

/// What the simulation's own fit means for the comparison; empty: nothing.
std::string overlapText(const SimulationOverlap& overlap, const std::string& simulation) {
  if (overlap.independent()) return "";
  if (!overlap.known)
    return format("; what the simulation %s was fitted to is not known, and may be these",
                  simulation.c_str());
  return format(
      "; the simulation %s was fitted to %zu of these, so it proves nothing: diagnose again "
      "without "
      "the trajectories that validate models (leave_out_validation)",
      simulation.c_str(), overlap.seen);
}

double meanRatio(const ErrorSummary& a, const ErrorSummary& b) {
  return 0.5 * (a.position_norm / b.position_norm + a.angle_norm / b.angle_norm);
}

std::string millimetresAndDegrees(const ErrorSummary& summary) {
  return format("%.2f mm, %.2f deg", 1e3 * summary.position_norm,
                summary.angle_norm * 180.0 / 3.14159265358979323846);
}

/// The states that a model is judged on, and which of them count.
struct CleanStates {
  std::vector<TestState> states;
  std::vector<bool> clean;
};
CleanStates statesFor(const Correction& model, const Dataset& held_out, double max_gap) {
  MotionOptions motion = model.motion;
  if (motion.velocity == VelocityKind::kCentral) motion.velocity = VelocityKind::kCausal;
  CleanStates out;
  const CleanGates gates;
  out.states = makeTestStates(held_out, motion, model.delay, max_gap, gates);
  out.clean = cleanStates(out.states, model.rigid, gates);
  if (std::none_of(out.clean.begin(), out.clean.end(), [](bool is_clean) { return is_clean; }))
    throw InvalidInput(
        format("%s: none of the %zu held-out states passes the gates of the clean "
               "set; are commands and observations in one frame, in metres?",
               held_out.source.c_str(), out.states.size()));
  return out;
}

/// Errors of the live model on the same observations, with its own motion features.
ErrorSummary errorsOfLive(const Correction& live, const Dataset& held_out, double delay,
                          double max_gap, const std::vector<bool>& clean) {
  const Predictor predictor(live);
  const std::vector<TestState> states =
      makeTestStates(held_out, live.motion, delay, max_gap, CleanGates());
  return summarise(pick(errorsOf(states, PredictionKind::kFull, &predictor), clean));
}

HeldOutErrors errorsOn(const CleanStates& judged, const Correction& model) {
  const Predictor predictor(model);
  const auto errors = [&](PredictionKind kind) {
    return pick(errorsOf(judged.states, kind, &predictor), judged.clean);
  };
  return {errors(PredictionKind::kNone), errors(PredictionKind::kRigid),
          errors(PredictionKind::kFull)};
}

}  // namespace

HeldOutErrors heldOutErrors(const Correction& model, const Dataset& held_out, double max_gap) {
  return errorsOn(statesFor(model, held_out, max_gap), model);
}

ValidatedTraining trainAndValidate(const Dataset& dataset, const TrainingConfig& config,
                                   const Correction* live, double now, const Progress& progress) {
  if (dataset.trajectories.size() < 3)
    throw InvalidInput(
        format("%s: %zu trajectories; at least 3 are needed, so that one can be "
               "held out: record more",
               dataset.source.c_str(), dataset.trajectories.size()));
  const auto [learn, held_out] = splitForValidation(dataset);
  ValidatedTraining result;
  result.held_out_trajectories = held_out.trajectories.size();
  result.training = train(learn, config, now, [&](const std::string& phase, double fraction) {
    if (progress) progress(phase, 0.9 * fraction);
  });
  if (progress) progress("validating", 0.9);

  Correction& model = result.training.model;
  const double max_gap = commandGapLimit(dataset, config);
  const CleanStates judged = statesFor(model, held_out, max_gap);
  result.errors = errorsOn(judged, model);
  result.none = summarise(result.errors.none);
  result.rigid = summarise(result.errors.rigid);
  result.full = summarise(result.errors.full);
  if (live != nullptr)
    result.live = errorsOfLive(*live, held_out, model.delay, max_gap, judged.clean);
  const ErrorSummary& reference = result.live ? *result.live : result.none;
  const double ratio = meanRatio(result.full, reference);
  result.better = ratio < 1.0;
  result.verdict = format("%s on %zu held-out states of %zu trajectories, against %s %s",
                          millimetresAndDegrees(result.full).c_str(), result.full.n,
                          held_out.trajectories.size(), millimetresAndDegrees(reference).c_str(),
                          result.live ? "of the model in use" : "without correction");
  if (held_out.trajectories.size() < kFewTrajectories)
    result.verdict += "; these are few, so it may err by more: record more motions";
  if (config.simulation) {
    result.overlap = overlapOf(*config.simulation, held_out);
    if (result.overlap->seen > 0) result.better = false;
    result.verdict += overlapText(*result.overlap, config.simulation->name);
  }
  model.held_out.position_before = result.none.position_norm;
  model.held_out.angle_before = result.none.angle_norm;
  model.held_out.position_after = result.full.position_norm;
  model.held_out.angle_after = result.full.angle_norm;
  if (progress) progress("validating", 1.0);
  return result;
}

}  // namespace raven_correction
