// SPDX-License-Identifier: BSD-3-Clause
#include "raven_correction/diagnosis/selection.h"

#include <algorithm>

#include "profile_deviation.h"
#include "raven_correction/diagnosis/noise_floor.h"
#include "raven_correction/error.h"
#include "selector.h"

namespace raven_correction {
namespace {

constexpr int kRefitIterations = 4;  // of a round: the next one goes on from there
constexpr double kRefitTolerance = 1e-5;
constexpr int kLastIterations = 25;
constexpr double kLastTolerance = 1e-6;

/// Hypotheses about what the simulation does not have yet: what it has stays as it is.
std::vector<Hypothesis> newHypotheses(const Recording& recording,
                                      const SimulationConfig& simulation) {
  std::vector<Hypothesis> all = allHypotheses(recording, simulation);
  const auto known = [&](const Hypothesis& hypothesis) {
    return std::any_of(hypothesis.parameters.begin(), hypothesis.parameters.end(),
                       [&](const ParameterHandle& handle) {
                         return parameterOf(simulation, handle).value != 0.0;
                       });
  };
  all.erase(std::remove_if(all.begin(), all.end(), known), all.end());
  return all;
}

}  // namespace

bool overlaps(const Hypothesis& a, const Hypothesis& b) {
  for (const ParameterHandle& one : a.parameters)
    if (std::find(b.parameters.begin(), b.parameters.end(), one) != b.parameters.end()) return true;
  return false;
}

SimulationConfig withoutParameters(const SimulationConfig& simulation,
                                   const std::vector<ParameterHandle>& parameters) {
  if (!simulation.find(parameters.front().effect)) return simulation;
  return withValues(simulation, parameters,
                    Eigen::VectorXd::Zero(static_cast<Eigen::Index>(parameters.size())));
}

Selector::Selector(const Recording& recording, const ResidualLayout& layout,
                   const SimulationConfig& simulation, const SelectionOptions& options,
                   const DiagnosisProgress& progress)
    : recording_(recording),
      layout_(layout),
      options_(options),
      progress_(progress),
      summary_(summarise(recording)),
      rule_(layout, options.least_share, options.seed),
      hypotheses_(newHypotheses(recording, simulation)) {
  problem_.recording = &recording;
  problem_.layout = &layout;
  problem_.simulation = simulation;
  problem_.max_iterations = kRefitIterations;
  problem_.tolerance = kRefitTolerance;
  fit_.residual = residuals(recording, layout, simulation, &result_.held_out);
  fit_.values.resize(0);
  fit_.jacobian.resize(layout.size, 0);
  held_out_ = fit_.residual;
  rule_.setNoise(noiseFloor(recording, simulation));
  result_.nominal_residual = fit_.residual;
  result_.hypotheses = hypotheses_.size();
}

SelectionResult Selector::run() {
  int round = 0;
  const auto is_full = [&] { return static_cast<int>(members_.size()) >= options_.max_causes; };
  while (!is_full() && add(round)) ++round;
  result_.stopped_at_most = is_full();
  removeWeak(Effort::kLinear);
  if (!members_.empty()) {  // nothing is added any more: to the end
    problem_.max_iterations = kLastIterations;
    problem_.tolerance = kLastTolerance;
    refit();
    releaseAtBounds();
    trimGroups();
    removeWeak(Effort::kLast);
  }
  result_.converged = members_.empty() || fit_.converged;
  say("comparing the causes with what explains as much", 0.96);
  finish();
  return std::move(result_);
}

void Selector::say(const std::string& phase, double fraction) const {
  if (progress_) progress_(phase, fraction);
}

void Selector::refit() {
  problem_.scales = channelScales(layout_, fit_.residual);
  problem_.frozen.resize(0, 0);
  fit_ = fitEffects(problem_);
  problem_.start = fit_.values;
  held_out_ = heldOutResiduals(problem_, fit_, options_.folds, &result_.held_out);
  rule_.setNoise(
      noiseFloor(recording_, withValues(problem_.simulation, problem_.parameters, fit_.values)));
}

Cause Selector::describe(const Member& member, const Eigen::VectorXd& dropped,
                         std::vector<Rival> rivals) const {
  Cause cause;
  cause.hypothesis = member.hypothesis;
  const auto k = static_cast<Eigen::Index>(member.hypothesis.parameters.size());
  cause.values.resize(k);
  cause.deviations = Eigen::VectorXd::Zero(k);
  cause.values.head(member.count) = fit_.values.segment(member.first, member.count);
  cause.deviations.head(member.count) =
      fit_.covariance.diagonal().segment(member.first, member.count).cwiseSqrt();
  for (Eigen::Index i = member.count; i < k; ++i) {
    const ParameterHandle& fixed = member.hypothesis.parameters[static_cast<std::size_t>(i)];
    cause.values(i) = parameterOf(problem_.simulation, fixed).value;
    cause.deviations(i) = profileDeviation(problem_, fit_, fixed, rule_);
  }
  const LossComparison comparison = rule_.compareWithInterval(dropped, held_out_);
  cause.share = comparison.share;
  cause.lower = comparison.lower;
  cause.upper = comparison.upper;
  cause.equals = std::move(rivals);
  cause.has_runner_up = member.has_runner_up && !isMember(member.runner_up);
  cause.runner_up = member.runner_up;
  cause.runner_up_share = member.runner_up_share;
  return cause;
}

void Selector::finish() {
  result_.simulation = withValues(problem_.simulation, problem_.parameters, fit_.values);
  std::vector<std::vector<Rival>> equals = rivals();
  for (std::size_t i = 0; i < members_.size(); ++i)
    result_.causes.push_back(describe(members_[i], dropped_[i].held_out, std::move(equals[i])));
  for (const Cause& cause : result_.causes) {
    std::unique_ptr<Effect> effect = result_.simulation.find(cause.hypothesis.effect)->clone();
    for (std::size_t i = 0; i < cause.hypothesis.parameters.size(); ++i)
      effect->setDeviation(cause.hypothesis.parameters[i].index,
                           cause.deviations(static_cast<Eigen::Index>(i)));
    result_.simulation.set(std::move(effect));
  }
  for (const Hypothesis& hypothesis : hypotheses_) {  // tried, and removed again
    const Effect* const effect = result_.simulation.find(hypothesis.effect);
    if (effect && std::all_of(effect->parameters().begin(), effect->parameters().end(),
                              [](const EffectParameter& p) { return p.value == 0.0; }))
      result_.simulation.remove(hypothesis.effect);
  }
  std::stable_sort(result_.causes.begin(), result_.causes.end(),
                   [](const Cause& a, const Cause& b) { return a.share > b.share; });
  result_.fitted_residual = fit_.residual;
  result_.held_out_residual = held_out_;
}
SelectionResult selectCauses(const Recording& recording, const ResidualLayout& layout,
                             const SimulationConfig& simulation, const SelectionOptions& options,
                             const DiagnosisProgress& progress) {
  if (options.folds < 2 || layout.motions < options.folds)
    throw InvalidInput(format("%s: %d motions, but %d folds; at least one motion is needed in each",
                              recording.name.c_str(), layout.motions, options.folds));
  return Selector(recording, layout, simulation, options, progress).run();
}

}  // namespace raven_correction
